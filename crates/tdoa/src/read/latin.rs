//! Latin-1 as Windows has it (code page 1252), which old programs and spreadsheets write.

/// The signs of the bytes 0x80 to 0x9f; NUL where there is none.
const SIGNS: [char; 32] = [
    '€', '\0', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\0', 'Ž', '\0', '\0', '‘', '’', '“', '”', '•',
    '–', '—', '˜', '™', 'š', '›', 'œ', '\0', 'ž', 'Ÿ',
];

/// A text of tables has more of ASCII than this many times what it has of other characters.
const PLAIN: usize = 3;

fn sign(byte: u8) -> char {
    match byte {
        0x80..=0x9f => SIGNS[usize::from(byte - 0x80)],
        _ => char::from(byte),
    }
}

/// Whether bytes from `from` on are text, of which most is ASCII; where they end.
///
/// # Errors
/// The first byte that is none, or `from` if too much is not ASCII.
pub(super) fn check(bytes: &[u8], from: usize) -> Result<usize, usize> {
    let new = &bytes[from..];
    let is_control = |&byte: &u8| sign(byte) == '\0' || (byte < b' ' && !b"\t\n\r\x0c".contains(&byte)) || byte == 0x7f;
    if let Some(at) = new.iter().position(is_control) {
        return Err(from + at);
    }
    let others = new.iter().filter(|byte| !byte.is_ascii()).count();
    if others * (PLAIN + 1) >= new.len() && others > 0 { Err(from) } else { Ok(bytes.len()) }
}

/// The text of bytes that [`check`] has found to be one.
pub(super) fn decode(bytes: &[u8]) -> String {
    bytes.iter().map(|&byte| sign(byte)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_told_from_other_bytes() {
        let text = b"Empf\xe4nger;1,5;2,5\nK\xfcche;3,5;\x964,5\n";
        assert_eq!(check(text, 0), Ok(text.len()));
        assert_eq!(decode(text), "Empfänger;1,5;2,5\nKüche;3,5;–4,5\n");
        assert_eq!(check(b"1,2\n\x00\xff", 0), Err(4));
        assert_eq!(check(b"1,2,3,4\n\x81", 0), Err(8));
        assert_eq!(check(&[0xff; 100], 0), Err(0));
        assert_eq!(check(b"", 0), Ok(0));
    }
}
