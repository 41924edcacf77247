//! The files that `tdoa calibrate` writes for people: the HTML report in a real browser, the table
//! of nodes.

use std::path::Path;
use std::process::Command;

use end_to_end::{program, root, run};

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

/// Runs in the page after its own script: sorts by clicks and leaves what it saw in the title.
const CHECK: &str = r##"<script>
const column = (id, k) => Array.from(document.querySelectorAll(`#${id} tbody tr`), (row) => row.cells[k].textContent);
const click = (id, k) => document.querySelectorAll(`#${id} th button`)[k].click();
const seen = [];
const names = column("transmitters", 0).join();
click("transmitters", 1);
const up = column("transmitters", 1).map(Number);
seen.push(up.every((x, k) => k === 0 || up[k - 1] <= x) ? "ascending" : "unsorted " + up);
click("transmitters", 1);
const down = column("transmitters", 1).map(Number);
seen.push(down.every((x, k) => k === 0 || down[k - 1] >= x) ? "descending" : "unsorted " + down);
click("transmitters", 0);
seen.push(column("transmitters", 0).join() === names ? "names in order" : column("transmitters", 0).join());
click("measurements", 4);
seen.push(document.querySelector("#measurements tbody tr").className + " first");
seen.push(document.querySelectorAll("svg path.receiver").length + " triangles");
seen.push(document.querySelectorAll("#evil, img").length + " injected");
seen.push(performance.getEntriesByType("resource").length + " fetched");
document.title = seen.join("; ");
</script>"##;

/// The title that a script has left, which a browser runs at the end of a page; `None` without a browser.
fn title_after(page: &str, script: &str, folder: &Path) -> Option<String> {
    let checked = folder.join("checked.html");
    std::fs::write(&checked, page.replace("</body>", &format!("{script}</body>"))).expect("written");
    let browser = Command::new("chromium")
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--no-first-run"])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .args(["--dump-dom", text(&checked)])
        .output();
    let browser = match browser {
        Ok(output) => output,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            eprintln!("skipped: no chromium to open the report in");
            return None;
        }
        Err(error) => panic!("chromium does not start: {error}"),
    };
    let page = String::from_utf8_lossy(&browser.stdout);
    let title = page.split_once("<title>").and_then(|(_, rest)| rest.split_once("</title>"));
    let title = title.unwrap_or_else(|| panic!("no page: {}", String::from_utf8_lossy(&browser.stderr))).0;
    Some(title.to_string())
}

#[test]
fn the_report_works_in_a_browser() {
    let directory = tempfile::tempdir().expect("directory");
    let folder = directory.path();
    // The example with a name that would be markup if it were not escaped.
    let table = std::fs::read_to_string(root().join("examples/network/pseudoranges.csv")).expect("example");
    let evil = "s12<img id=evil src=x onerror=alert(1)>";
    assert!(table.contains("s12"));
    let file = folder.join("pseudoranges.csv");
    std::fs::write(&file, table.replace("s12", evil)).expect("written");
    let report = folder.join("report.html");
    let output = run("tdoa", &["calibrate", text(&file), "--sigma", "0.02", "--html", text(&report)]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = std::fs::read_to_string(&report).expect("report");
    assert!(page.contains("&lt;img id=evil") && !page.contains("<img"));

    let Some(title) = title_after(&page, CHECK, folder) else { return };
    // Eight receivers and one in the legend; the example has an outlier.
    assert_eq!(title, "ascending; descending; names in order; outlier first; 9 triangles; 0 injected; 0 fetched");
}

/// Presses the buttons of the view that turns. From each side, two coordinates of the transmitters are those of the
/// dots in the picture, at one scale, and an ellipsoid is as wide as its matrix says.
const VIEWS: &str = r##"<script>
const { receivers, transmitters } = JSON.parse(document.getElementById("network").textContent);
const sorted = (values) => values.sort((a, b) => a - b);
const all = (name, part) => Array.from(document.querySelectorAll(`#turn svg ${name}`), part);
// The factor from one list to the other, if there is one.
const factor = (from, to) => {
  const scale = (to.at(-1) - to[0]) / (from.at(-1) - from[0]);
  return from.every((x, k) => Math.abs(to[0] + scale * (x - from[0]) - to[k]) < 0.01) ? scale : NaN;
};
const seen = [];
for (const [name, right, up] of [["from above", 0, 1], ["from the front", 0, 2], ["from the side", 1, 2]]) {
  const button = Array.from(document.querySelectorAll("#turn button")).find((b) => b.textContent === name);
  button.click();
  const at = (k) => sorted(transmitters.map((node) => node.at[k]));
  const across = factor(at(right), sorted(all("circle", (c) => Number(c.getAttribute("cx")))));
  const above = factor(at(up), sorted(all("circle", (c) => -Number(c.getAttribute("cy")))));
  const trace = (k) => [...receivers, ...transmitters].reduce((sum, node) => sum + node.ellipsoid[k][k], 0);
  const squares = all("ellipse", (e) => e.getAttribute("rx") ** 2 + e.getAttribute("ry") ** 2).reduce((a, b) => a + b);
  const fits = Math.abs(squares / (across ** 2 * (trace(right) + trace(up))) - 1) < 1e-3;
  const pressed = Array.from(document.querySelectorAll("#turn [aria-pressed=true]"), (b) => b.textContent).join();
  seen.push(`${pressed}: ${Math.abs(across / above - 1) < 1e-3 && across > 0 ? "in place" : [across, above]}, ${fits ? "true" : squares}`);
}
document.title = seen.join("; ");
</script>"##;

#[test]
fn a_network_in_space_is_seen_from_three_sides() {
    let directory = tempfile::tempdir().expect("directory");
    let report = directory.path().join("report.html");
    let file = root().join("examples/room/pseudoranges.csv");
    let output = run("tdoa", &["calibrate", text(&file), "--html", text(&report)]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = std::fs::read_to_string(&report).expect("report");
    let Some(title) = title_after(&page, VIEWS, directory.path()) else { return };
    let views = ["from above", "from the front", "from the side"].map(|view| format!("{view}: in place, true"));
    assert_eq!(title, views.join("; "));
}

/// The definition of a term in a report.
fn entry<'a>(page: &'a str, term: &str) -> &'a str {
    let rest = page.split_once(&format!("<dt>{term}</dt><dd>")).unwrap_or_else(|| panic!("{term} in {page}")).1;
    rest.split_once("</dd>").expect("end of the entry").0
}

#[test]
fn the_report_says_where_it_comes_from() {
    let directory = tempfile::tempdir().expect("directory");
    let table = std::fs::read(root().join("examples/network/pseudoranges.csv")).expect("example");
    std::fs::write(directory.path().join("a & b's.csv"), table).expect("written");
    let report = |words: &[&str], date: Option<&str>| {
        let mut command = Command::new(program("tdoa"));
        command.current_dir(directory.path()).args(["calibrate", "a & b's.csv", "--html", "r.html"]).args(words);
        match date {
            Some(date) => command.env("SOURCE_DATE_EPOCH", date),
            None => command.env_remove("SOURCE_DATE_EPOCH"),
        };
        let output = command.output().expect("the program starts");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), said, std::fs::read_to_string(directory.path().join("r.html")).unwrap_or_default())
    };
    let (status, said, page) = report(&["--sigma", "0.02", "--dimensions", "2"], Some("1000000000"));
    assert_eq!(status, Some(0), "{said}");
    assert_eq!(entry(&page, "File"), "a &amp; b&#39;s.csv");
    assert_eq!(entry(&page, "Date"), "2001-09-09 01:46:40 UTC");
    assert_eq!(entry(&page, "Program"), concat!("tdoa ", env!("CARGO_PKG_VERSION")));
    let words = r"tdoa calibrate 'a & b'\''s.csv' --html r.html --sigma 0.02 --dimensions 2";
    let escaped = words.replace('&', "&amp;").replace('\'', "&#39;");
    assert_eq!(entry(&page, "Command"), format!("<code>{escaped}</code>"));
    let settings = entry(&page, "Settings").replace('\u{a0}', " ");
    assert!(settings.contains("dimensions 2, sigma 0.02, ") && settings.contains("seed 0"), "{settings}");
    assert_eq!(entry(&page, "Dimensions"), "in the plane, as --dimensions says");
    // No time is told that would differ, and the same command writes the same bytes.
    assert!(!page.contains("Time taken"));
    assert!(report(&["--sigma", "0.02", "--dimensions", "2"], Some("1000000000")).2 == page);
    // Without a given date it is the present one, with the time taken; the measurements chose the plane.
    let (_, _, page) = report(&[], None);
    let year: i32 = entry(&page, "Date")[..4].parse().expect("year");
    assert!(year >= 2024 && entry(&page, "Time taken").ends_with(" s"), "{year}");
    let chosen = entry(&page, "Dimensions");
    assert!(chosen.starts_with("in the plane: heights make the measurements less likely, by "), "{chosen}");
    // A date that is none is refused before the work begins.
    let (status, said, _) = report(&[], Some("yesterday"));
    assert!(status == Some(2) && said.contains("SOURCE_DATE_EPOCH"), "{said}");
}

#[test]
fn the_table_of_nodes_can_be_compared_with() {
    let directory = tempfile::tempdir().expect("directory");
    let nodes = directory.path().join("nodes.csv");
    let file = root().join("examples/network/pseudoranges.csv");
    let output = run("tdoa", &["calibrate", text(&file), "--nodes", text(&nodes)]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let table = std::fs::read_to_string(&nodes).expect("table");
    assert!(table.starts_with("kind,name,x,y,std_x,std_y,cov_xy,offset,std_offset,measurements,outliers\n"));
    assert_eq!(table.lines().filter(|line| line.starts_with("receiver,")).count(), 8);
    assert_eq!(table.lines().filter(|line| line.starts_with("transmitter,")).count(), 12);
    // Compared with itself the network is where it is.
    let output = run("tdoa", &["calibrate", text(&file), "--truth", text(&nodes), "--json", "-"]);
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert!(found["truth"]["receiver_rms"].as_f64().expect("number") < 1e-9);
}
