//! Images of few colours, as browsers read them.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Colours of an image.
pub(super) type Palette = [[u8; 3]; 256];

/// An image as an address that holds it: a Windows bitmap of one byte a pixel, which needs no compression. `rows` are numbers of
/// colours, from below to above, of the same length each.
pub(super) fn address(rows: &[Vec<u8>], palette: &Palette) -> String {
    let width = rows.first().map_or(0, Vec::len);
    // Each row is filled up to a multiple of four bytes.
    let stride = width.next_multiple_of(4);
    let start = 54 + 4 * palette.len();
    let mut file = Vec::with_capacity(start + stride * rows.len());
    let mut numbers = |all: &[u32]| all.iter().for_each(|number| file.extend(number.to_le_bytes()));
    // The header: size of the file, where pixels begin; then 40 bytes of what the image is: one plane of eight bits, not compressed.
    let [start, stride, height, columns] = [start, stride, rows.len(), width].map(|number| number as u32);
    numbers(&[start + stride * height, 0, start, 40, columns, height, 1 | 8 << 16, 0, stride * height, 0, 0, 256, 0]);
    file.splice(0..0, *b"BM");
    palette.iter().for_each(|[red, green, blue]| file.extend([*blue, *green, *red, 0]));
    for row in rows {
        file.extend(row);
        file.resize(file.len() + stride as usize - width, 0);
    }
    format!("data:image/bmp;base64,{}", STANDARD.encode(file))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rows of three pixels by the description of the format: the size, the first pixels and the fill of each row.
    #[test]
    fn a_small_image() {
        let mut palette = [[0; 3]; 256];
        palette[7] = [1, 2, 3];
        let text = address(&[vec![7, 0, 1], vec![2, 3, 4]], &palette);
        let file = STANDARD.decode(text.strip_prefix("data:image/bmp;base64,").unwrap()).unwrap();
        assert_eq!((&file[..2], file.len()), (&b"BM"[..], 14 + 40 + 1024 + 2 * 4));
        let number = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap());
        assert_eq!([2, 10, 14, 18, 22, 26].map(number), [1086, 1078, 40, 3, 2, 1 + (8 << 16)]);
        assert_eq!(file[54 + 28..54 + 32], [3, 2, 1, 0]);
        assert_eq!(file[1078..], [7, 0, 1, 0, 2, 3, 4, 0]);
    }
}
