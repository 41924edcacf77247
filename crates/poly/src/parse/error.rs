//! What is wrong with a text, and where.

/// An error in a text, with its place.
///
/// Displays as the message followed by the line in question and a caret below the column.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}line {line}, column {column}: {message}\n  {snippet}\n  {}^", .within.as_ref().map(|w| format!("{w}, ")).unwrap_or_default(), " ".repeat(*.caret))]
pub struct ParseError {
    /// What is wrong and what to do.
    pub message: String,
    /// The part of the text that line and column are counted in, such as `equation 2`; `None` for
    /// the whole text.
    pub within: Option<String>,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The line in question, shortened around the column where it is long.
    pub snippet: String,
    /// Column of the error within `snippet`, from 0.
    pub caret: usize,
}

/// Characters shown on either side of the place.
const CONTEXT: usize = 50;

impl ParseError {
    /// An error at a byte offset of the text.
    pub(crate) fn at(text: &str, offset: usize, message: impl Into<String>) -> ParseError {
        let mut offset = offset.min(text.len());
        while !text.is_char_boundary(offset) {
            offset -= 1;
        }
        let start = text[..offset].rfind('\n').map_or(0, |k| k + 1);
        let end = text[offset..].find('\n').map_or(text.len(), |k| offset + k);
        let line = text[..start].bytes().filter(|&b| b == b'\n').count() + 1;
        let column = text[start..offset].chars().count();
        let skip = column.saturating_sub(CONTEXT);
        let snippet: String = text[start..end]
            .chars()
            .skip(skip)
            .take(2 * CONTEXT)
            .map(|c| if c.is_control() { ' ' } else { c })
            .collect();
        ParseError {
            message: message.into(),
            within: None,
            line,
            column: column + 1,
            snippet: snippet.trim_end().to_owned(),
            caret: column - skip,
        }
    }

    /// Says in which part of a larger text the place is counted.
    pub(crate) fn within(mut self, part: impl Into<String>) -> ParseError {
        self.within = Some(part.into());
        self
    }
}
