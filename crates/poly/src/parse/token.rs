//! Tokens of formulas.

use super::error::ParseError;
use crate::exact::Exact;
use num_bigint::BigInt;
use num_complex::Complex;
use num_rational::BigRational;
use num_traits::Zero;

/// Longest decimal exponent: `1e-400` is kept exactly, `1e999999999` would not fit in memory.
const EXPONENT_LIMIT: i64 = 4_000;
/// Most digits of one number.
const DIGIT_LIMIT: usize = 10_000;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token<'t> {
    Number(Exact),
    Name(&'t str),
    Plus,
    Minus,
    Times,
    Over,
    Power,
    /// An exponent in superscript digits, as in `x²`; too large ones are the largest number.
    Superscript(i64),
    Open,
    Close,
    Semicolon,
    Equals,
    Colon,
    Comma,
    /// The end of a line outside parentheses, where lines have a meaning.
    LineEnd,
    End,
}

impl Token<'_> {
    /// How the token is named in messages.
    pub(super) fn describe(&self) -> String {
        match self {
            Token::Number(_) => "a number".to_owned(),
            Token::Name(name) => format!("`{name}`"),
            Token::Plus => "`+`".to_owned(),
            Token::Minus => "`-`".to_owned(),
            Token::Times => "`*`".to_owned(),
            Token::Over => "`/`".to_owned(),
            Token::Power => "`^`".to_owned(),
            Token::Superscript(exponent) => format!("the superscript {exponent}"),
            Token::Open => "`(`".to_owned(),
            Token::Close => "`)`".to_owned(),
            Token::Semicolon => "`;`".to_owned(),
            Token::Equals => "`=`".to_owned(),
            Token::Colon => "`:`".to_owned(),
            Token::Comma => "`,`".to_owned(),
            Token::LineEnd => "the end of the line".to_owned(),
            Token::End => "the end of the text".to_owned(),
        }
    }
}

/// Reads tokens one at a time with one token of look-ahead.
pub(super) struct Tokens<'t> {
    text: &'t str,
    /// Where the next unread character is.
    position: usize,
    current: Token<'t>,
    /// Where the current token begins.
    start: usize,
    /// Whether line ends are tokens and `#` begins a comment.
    lines: bool,
    /// Parentheses that are open after the current token.
    open: usize,
}

impl<'t> Tokens<'t> {
    /// Begins at a byte offset of the text. Line ends are white space.
    pub(super) fn new(text: &'t str, position: usize) -> Result<Tokens<'t>, ParseError> {
        Tokens::begin(text, position, false)
    }

    /// Begins a text in which line ends are tokens, except in parentheses, and `#` begins a
    /// comment.
    pub(super) fn with_lines(text: &'t str) -> Result<Tokens<'t>, ParseError> {
        Tokens::begin(text, 0, true)
    }

    fn begin(text: &'t str, position: usize, lines: bool) -> Result<Tokens<'t>, ParseError> {
        let mut tokens = Tokens { text, position, current: Token::End, start: position, lines, open: 0 };
        tokens.advance()?;
        Ok(tokens)
    }

    pub(super) fn current(&self) -> &Token<'t> {
        &self.current
    }

    /// Byte offset of the current token.
    pub(super) fn offset(&self) -> usize {
        self.start
    }

    /// An error at the current token.
    pub(super) fn error(&self, message: impl Into<String>) -> ParseError {
        ParseError::at(self.text, self.start, message)
    }

    /// An error at a byte offset.
    pub(super) fn error_at(&self, offset: usize, message: impl Into<String>) -> ParseError {
        ParseError::at(self.text, offset, message)
    }

    /// Steps to the next token.
    pub(super) fn advance(&mut self) -> Result<(), ParseError> {
        let trimmed = self.skip_space();
        self.start = self.text.len() - trimmed.len();
        let Some(first) = trimmed.chars().next() else {
            self.position = self.start;
            self.current = Token::End;
            return Ok(());
        };
        let (token, length) = match first {
            '+' => (Token::Plus, 1),
            '-' => (Token::Minus, 1),
            '*' if trimmed[1..].starts_with('*') => (Token::Power, 2),
            '*' => (Token::Times, 1),
            // As editors and printed papers have them: minus sign and en dash, middle dot, bullet and dot operator.
            '\u{2212}' | '\u{2013}' => (Token::Minus, first.len_utf8()),
            '×' | '\u{b7}' | '\u{2219}' | '\u{22c5}' => (Token::Times, first.len_utf8()),
            '/' => (Token::Over, 1),
            '^' => (Token::Power, 1),
            '(' => (Token::Open, 1),
            ')' => (Token::Close, 1),
            ';' => (Token::Semicolon, 1),
            '=' => (Token::Equals, 1),
            ':' => (Token::Colon, 1),
            ',' => (Token::Comma, 1),
            '\n' => (Token::LineEnd, 1),
            c if c.is_ascii_digit() || c == '.' => {
                let (value, length) = self.number(trimmed)?;
                (Token::Number(value), length)
            }
            c if begins_name(c) => {
                let length = trimmed.find(|c: char| !continues_name(c)).unwrap_or(trimmed.len());
                (Token::Name(&trimmed[..length]), length)
            }
            c if is_superscript(c) => self.superscript(trimmed)?,
            c => return Err(self.error(format!("unexpected character {c:?}"))),
        };
        match token {
            Token::Open => self.open += 1,
            Token::Close => self.open = self.open.saturating_sub(1),
            _ => {}
        }
        self.position = self.start + length;
        self.current = token;
        Ok(())
    }

    /// The unread text from the next token on.
    fn skip_space(&self) -> &'t str {
        let mut rest = &self.text[self.position..];
        if !self.lines {
            return rest.trim_start();
        }
        loop {
            rest = rest.trim_start_matches(|c: char| c.is_whitespace() && (c != '\n' || self.open > 0));
            if !rest.starts_with('#') {
                return rest;
            }
            rest = &rest[rest.find('\n').unwrap_or(rest.len())..];
        }
    }

    /// Whether the token after the current one is a colon.
    pub(super) fn colon_follows(&self) -> bool {
        self.skip_space().starts_with(':')
    }

    /// An exponent in superscript, with or without a sign, and its length in bytes.
    fn superscript(&self, text: &str) -> Result<(Token<'t>, usize), ParseError> {
        let length = text.find(|c: char| !is_superscript(c)).unwrap_or(text.len());
        let plain: Option<String> = text[..length].chars().map(of_superscript).collect();
        let digits = plain.as_deref().map(|plain| plain.strip_prefix(['+', '-']).unwrap_or(plain));
        match (plain.as_deref(), digits) {
            (Some(plain), Some(digits)) if !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit()) => {
                let most = if plain.starts_with('-') { i64::MIN } else { i64::MAX };
                Ok((Token::Superscript(plain.parse().unwrap_or(most)), length))
            }
            _ => Err(self.error(format!("the superscript `{}` is no whole number; write `^`", &text[..length]))),
        }
    }

    /// An unsigned decimal number, kept exactly, and its length in bytes.
    fn number(&self, text: &str) -> Result<(Exact, usize), ParseError> {
        let bytes = text.as_bytes();
        let digits_from = |from: usize| from + bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
        let whole = digits_from(0);
        let mut end = whole;
        let mut fraction = "";
        if bytes.get(whole) == Some(&b'.') {
            end = digits_from(whole + 1);
            fraction = &text[whole + 1..end];
        }
        if whole + fraction.len() == 0 {
            return Err(self.error("a number needs digits"));
        }
        if whole + fraction.len() > DIGIT_LIMIT {
            return Err(self.error(format!("a number of more than {DIGIT_LIMIT} digits")));
        }
        let mut exponent = 0;
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let signed = end + 1 + usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            let stop = digits_from(signed.min(bytes.len()));
            if stop > signed {
                exponent = text[end + 1..stop].parse::<i64>().unwrap_or(i64::MAX);
                if exponent.unsigned_abs() > EXPONENT_LIMIT.unsigned_abs() {
                    return Err(self.error(format!("a decimal exponent beyond {EXPONENT_LIMIT} in size")));
                }
                end = stop;
            }
        }
        let digits: BigInt = format!("0{}{fraction}", &text[..whole]).parse().unwrap_or_default();
        let scale = exponent - i64::try_from(fraction.len()).unwrap_or(0);
        let power = BigInt::from(10).pow(u32::try_from(scale.unsigned_abs()).unwrap_or(0));
        let value = if scale < 0 { BigRational::new(digits, power) } else { BigRational::from_integer(digits * power) };
        Ok((Complex::new(value, BigRational::zero()), end))
    }
}

/// Superscript digits in their order.
const SUPERSCRIPTS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];

/// Whether a character stands raised, as in an exponent.
fn is_superscript(c: char) -> bool {
    SUPERSCRIPTS.contains(&c) || matches!(c, 'ⁱ' | 'ⁿ' | '⁺'..='⁾')
}

/// The character of a whole number that a superscript stands for.
fn of_superscript(c: char) -> Option<char> {
    match c {
        '⁺' => Some('+'),
        '⁻' => Some('-'),
        _ => SUPERSCRIPTS.iter().zip('0'..).find(|&(&superscript, _)| superscript == c).map(|(_, digit)| digit),
    }
}

/// Whether a name can begin with this character.
pub(crate) fn begins_name(c: char) -> bool {
    (c.is_alphabetic() || c == '_') && !is_superscript(c)
}

/// Whether a name can go on with this character: letters, digits, subscripts; no exponents and no fractions like `½`.
pub(crate) fn continues_name(c: char) -> bool {
    let fraction = matches!(c, '¼'..='¾' | '\u{2150}'..='\u{215f}' | '\u{2189}');
    (c.is_alphanumeric() || c == '_') && !is_superscript(c) && !fraction
}
