//! Tables that sort by a click on a heading.

use std::fmt::Write;

use crate::picture::escape;

/// A column of a table: its heading, and whether it holds text instead of numbers.
pub(super) type Column<'a> = (&'a str, bool);

/// A table with a heading that sorts; cells are escaped here.
pub(super) fn table(id: &str, columns: &[Column<'_>], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let class = |text: bool| if text { " class=\"text\"" } else { "" };
    let mut html = format!("<div class=\"scroll\"><table id=\"{id}\">\n<thead><tr>");
    // Writing to a string does not fail.
    for (name, text) in columns {
        let _ = write!(html, "<th scope=\"col\"{}><button type=\"button\">{name}</button></th>", class(*text));
    }
    html += "</tr></thead>\n<tbody>\n";
    for row in rows {
        let outlier = row.last().is_some_and(|cell| cell == "outlier");
        html += if outlier { "<tr class=\"outlier\">" } else { "<tr>" };
        for (cell, (_, text)) in row.iter().zip(columns) {
            let _ = write!(html, "<td{}>{}</td>", class(*text), escape(cell));
        }
        html += "</tr>\n";
    }
    html + "</tbody>\n</table></div>\n"
}
