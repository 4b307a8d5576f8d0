//! A plotter's alphabet: capitals, digits and a few signs as strokes, so that names need no font on the machine.

use glam::DVec2;

/// Height of capitals, in the units of the strokes.
const CAP: f64 = 6.0;
/// Space after a glyph.
const GAP: f64 = 2.0;

/// Strokes of a glyph, separated by commas. Each point is two digits: x, and y up from the base line.
fn strokes(letter: char) -> &'static str {
    match letter {
        'A' => "002640,1232",
        'B' => "00063645443303,3342413000",
        'C' => "4536160501103041",
        'D' => "00062644422000",
        'E' => "46060040,0333",
        'F' => "460600,0333",
        'G' => "45361605011030414323",
        'H' => "0006,4046,0343",
        'I' => "0006",
        'J' => "3631201001",
        'K' => "0006,460340",
        'L' => "060030",
        'M' => "0006234640",
        'N' => "00064046",
        'O' | '0' => "100105163645413010",
        'P' => "00063645443303",
        'Q' => "100105163645413010,2240",
        'R' => "00063645443303,2340",
        'S' => "453616050413334241301001",
        'T' => "0646,2620",
        'U' => "060110304146",
        'V' => "062046",
        'W' => "0610243046",
        'X' => "0046,0640",
        'Y' => "062346,2320",
        'Z' => "06460040",
        '1' => "051610",
        '2' => "05163645440040",
        '3' => "05163645443313,334241301001",
        '4' => "30360242",
        '5' => "460604344341301001",
        '6' => "4536160501103041423303",
        '7' => "064610",
        '8' => "13040516364544331302011030414233",
        '9' => "0110304145361605041343",
        'k' => "0006,3402,1330",
        'm' => "0004,03142320,23344340",
        '-' => "0333",
        '+' => "0333,1521",
        '/' => "0026",
        ',' => "0111",
        ':' => "0000,0404",
        '\'' => "0605",
        '.' => "0000",
        _ => "",
    }
}

/// A capital without its accent.
fn plain(letter: char) -> char {
    const ACCENTS: [(char, &str); 14] = [
        ('A', "ÀÁÂÃÄÅĀĂĄÆ"),
        ('C', "ÇĆĈĊČ"),
        ('D', "ĎĐÐ"),
        ('E', "ÈÉÊËĒĖĘĚ"),
        ('G', "ĞĢ"),
        ('I', "ÌÍÎÏĪĮİ"),
        ('L', "ĹĽŁ"),
        ('N', "ÑŃŅŇ"),
        ('O', "ÒÓÔÕÖØŌŐŒ"),
        ('R', "ŔŘ"),
        ('S', "ŚŞŠȘ"),
        ('U', "ÙÚÛÜŪŮŰŲ"),
        ('Y', "ÝŸ"),
        ('Z', "ŹŻŽ"),
    ];
    ACCENTS.iter().find(|(_, all)| all.contains(letter)).map_or(letter, |(plain, _)| *plain)
}

/// Strokes and width of `text` with capitals `height` tall. y runs up, and the left end of the base line is at (0, 0). Accents
/// are dropped; letters without strokes leave a gap.
pub(crate) fn write(text: &str, height: f64) -> (Vec<Vec<DVec2>>, f64) {
    let unit = height / CAP;
    let (mut lines, mut x) = (Vec::new(), 0.0);
    for letter in text.chars().map(plain) {
        let mut width: f64 = 0.0;
        for stroke in strokes(letter).split(',').filter(|s| !s.is_empty()) {
            let digit = |b: u8| f64::from(b - b'0');
            let points = stroke.as_bytes().chunks_exact(2).map(|p| DVec2::new(digit(p[0]), digit(p[1])));
            width = points.clone().map(|p| p.x).fold(width, f64::max);
            lines.push(points.map(|p| (p + DVec2::X * x) * unit).collect());
        }
        x += if strokes(letter).is_empty() { GAP } else { width + GAP };
    }
    (lines, (x - GAP).max(0.0) * unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_capital_and_digit_has_strokes_within_its_box() {
        for letter in ('A'..='Z').chain('0'..='9') {
            let (lines, width) = write(&letter.to_string(), 12.0);
            assert!(!lines.is_empty() && width <= 8.0, "{letter}");
            let inside = |p: &DVec2| (0.0..=width).contains(&p.x) && (0.0..=12.0).contains(&p.y);
            assert!(lines.iter().all(|l: &Vec<DVec2>| l.len() > 1 && l.iter().all(inside)), "{letter}");
        }
    }
}
