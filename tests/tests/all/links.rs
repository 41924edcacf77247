//! Relative links of the Markdown pages: the file is there, and so is the heading.

use std::path::{Path, PathBuf};

use end_to_end::root;

/// The lines of a page outside fenced code.
fn prose(page: &str) -> impl Iterator<Item = &str> {
    let mut fenced = false;
    page.lines().filter(move |line| {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        !fenced && !fence
    })
}

/// The anchors of a page's headings, as GitHub makes them; of equal headings only the first.
fn anchors(page: &str) -> Vec<String> {
    let headings = prose(page).filter(|line| line.starts_with('#'));
    let titles = headings.map(|line| line.trim_start_matches('#').trim().to_lowercase());
    let kept = |c: &char| c.is_alphanumeric() || " -_".contains(*c);
    titles.map(|title| title.chars().filter(kept).collect::<String>().replace(' ', "-")).collect()
}

/// The targets of a page's links, `](target)`, that are not addresses of the web.
fn targets(page: &str) -> Vec<String> {
    let text = prose(page).collect::<Vec<_>>().join("\n");
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
    let targets = targets.map(|(target, _)| target.to_owned());
    targets.filter(|target| !target.contains("://") && !target.starts_with("mailto:")).collect()
}

/// The links of a page that lead nowhere.
fn dead(path: &Path) -> Vec<String> {
    let page = std::fs::read_to_string(path).expect("a page");
    let leads_nowhere = |target: &String| {
        let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
        let file = match file {
            "" => path.to_path_buf(),
            file => path.parent().expect("a page lies in a folder").join(file),
        };
        if anchor.is_empty() || file.extension().is_none_or(|end| end != "md") {
            return !file.exists();
        }
        !std::fs::read_to_string(file).is_ok_and(|page| anchors(&page).iter().any(|known| known == anchor))
    };
    targets(&page).into_iter().filter(leads_nowhere).collect()
}

/// The pages in a folder and, where told so, in the folders below it.
fn pages(folder: &Path, below: bool) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder of the workspace") {
        let path = entry.expect("an entry").path();
        if path.is_dir() && below {
            found.extend(pages(&path, below));
        } else if path.extension().is_some_and(|end| end == "md") {
            found.push(path);
        }
    }
    found
}

#[test]
fn links_between_pages_and_files_lead_somewhere() {
    let mut found = pages(root(), false);
    found.extend(["docs", "examples", "results"].iter().flat_map(|folder| pages(&root().join(folder), true)));
    for package in std::fs::read_dir(root().join("crates")).expect("folder of the crates") {
        found.extend(pages(&package.expect("a crate").path(), false));
    }
    for known in ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/features.md", "crates/benches/README.md"] {
        assert!(found.contains(&root().join(known)), "{known}");
    }
    let name = |page: &Path| page.strip_prefix(root()).unwrap_or(page).display().to_string();
    let dead: Vec<String> = found
        .iter()
        .flat_map(|page| dead(page).into_iter().map(|target| format!("{}: {target}", name(page))))
        .collect();
    assert!(dead.is_empty(), "links that lead nowhere:\n{}", dead.join("\n"));
}

#[test]
fn a_dead_link_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = folder.path().join("page.md");
    let other = "# `hc solve`: a title\n```text\n# not a title\n[x](nowhere.md)\n```\n## Second_part\n";
    std::fs::write(folder.path().join("other.md"), other).expect("written");
    let text = "# Here\n[a](other.md), [b\nc](other.md#hc-solve-a-title) [d](#here) [e](https://example.org/x.md)\n\
                [f](other.md#not-a-title) ![g](picture.svg) [h](#there) [i](.) [j](gone.md#x) [k](other.md#second_part)\n";
    std::fs::write(&page, text).expect("written");
    assert_eq!(dead(&page), ["other.md#not-a-title", "picture.svg", "#there", "gone.md#x"]);
    assert!(dead(&folder.path().join("other.md")).is_empty());
}
