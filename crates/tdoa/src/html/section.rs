//! Parts of a page that programs add: what a calibration comes from, such as recordings.

use std::fmt::Write;

use super::table::table;
use crate::picture::escape;

const STYLE: &str = include_str!("style.css");
const SORT: &str = include_str!("sort.js");

/// A part of a page, with a heading. Text is escaped; pictures are put in as they are.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Section {
    html: String,
}

impl Section {
    /// A part with this heading and nothing below it yet.
    pub fn new(heading: &str) -> Section {
        Section { html: format!("<h2>{}</h2>\n", escape(heading)) }
    }

    /// With a paragraph in small print.
    pub fn note(mut self, text: &str) -> Section {
        // Writing to a string does not fail.
        let _ = writeln!(self.html, "<p class=\"note\">{}</p>", escape(text));
        self
    }

    /// With a paragraph that stands out.
    pub fn warning(mut self, text: &str) -> Section {
        let _ = writeln!(self.html, "<p class=\"warning\">{}</p>", escape(text));
        self
    }

    /// With a table that sorts, with an `id` that no other one of the page has. Columns have a heading each, and hold text or
    /// numbers.
    pub fn table(mut self, id: &str, columns: &[(&str, bool)], rows: Vec<Vec<String>>) -> Section {
        self.html += &table(id, columns, rows);
        self
    }

    /// With an SVG picture.
    pub fn picture(mut self, svg: &str) -> Section {
        let _ = writeln!(self.html, "<figure>\n{svg}</figure>");
        self
    }

    /// With an SVG picture that opens below a line of text.
    pub fn folded_picture(mut self, text: &str, svg: &str) -> Section {
        let _ = writeln!(self.html, "<details><summary>{}</summary>\n<figure>\n{svg}</figure></details>", escape(text));
        self
    }

    /// The part as HTML text.
    pub(super) fn html(&self) -> &str {
        &self.html
    }
}

/// A page of these parts, in the style of the report of a calibration and as self-contained.
///
/// ```
/// use tdoa::html::{Section, page};
///
/// let rows = vec![vec!["left:1".to_string(), "12".to_string()]];
/// let section = Section::new("Channels").table("channels", &[("channel", true), ("sounds", false)], rows);
/// assert!(page("What was heard", &[section]).contains("<td class=\"text\">left:1</td>"));
/// ```
pub fn page(title: &str, sections: &[Section]) -> String {
    let body: String = sections.iter().map(Section::html).collect();
    frame(title, "", &body)
}

/// A page with this title and this body; further style is put behind the common one.
pub(super) fn frame(title: &str, style: &str, body: &str) -> String {
    let title = escape(title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{STYLE}{style}</style>\n</head>\n<body>\n<h1>{title}</h1>\n{body}<script>\n{SORT}</script>\n</body>\n</html>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::{Section, page};

    #[test]
    fn text_is_escaped_and_pictures_are_not() {
        let section = Section::new("a<b").note("1 < 2").warning("x & y").picture("<svg></svg>\n");
        let section = section.folded_picture("\"more\"", "<svg></svg>\n");
        let text = page("</title>", &[section, Section::new("two")]);
        assert!(text.contains("<h2>a&lt;b</h2>") && text.contains("1 &lt; 2") && text.contains("x &amp; y"));
        assert!(text.contains("<summary>&quot;more&quot;</summary>") && text.matches("<svg></svg>").count() == 2);
        assert_eq!((text.matches("</title>").count(), text.matches("<h2>").count()), (1, 2));
    }
}
