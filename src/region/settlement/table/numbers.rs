//! Numbers as people write them in tables.

/// A number with a decimal point. The error says what else the text may be, or is empty.
pub(super) fn number(text: &str) -> Result<f64, &'static str> {
    text.parse().map_err(|_| match is_grouped(text) || text.replacen(',', ".", 1).parse::<f64>().is_ok() {
        true => ", with a decimal point and nothing between thousands",
        false => "",
    })
}

/// A number of inhabitants, in which thousands may be set apart: `1,200`, `1 200`, `1'200`, `1.234.567`.
pub(super) fn inhabitants(text: &str) -> Result<f64, &'static str> {
    let is_grouped = is_grouped(text);
    // 1.2, or 1200 as some countries write it.
    if is_grouped && text.matches('.').count() == 1 {
        return Err("; a point before three digits may stand for thousands: leave it out");
    }
    if is_grouped {
        return text.replace(|c: char| !c.is_ascii_digit(), "").parse().map_err(|_| "");
    }
    number(text)
}

/// Whether the digits stand in groups of three, all with the same sign between them.
fn is_grouped(text: &str) -> bool {
    let Some(sign) = text.chars().find(|c| !c.is_ascii_digit()) else { return false };
    let groups: Vec<&str> = text.split(sign).collect();
    let is_of_digits = |group: &str| group.chars().all(|c| c.is_ascii_digit());
    ",.'\u{2019}_ \u{a0}\u{202f}".contains(sign)
        && (1..=3).contains(&groups[0].len())
        && groups[1..].iter().all(|g| g.len() == 3)
        && groups.iter().all(|g| is_of_digits(g))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_may_be_set_apart_where_people_are_counted() {
        for text in ["1234567", "1,234,567", "1.234.567", "1 234 567", "1'234'567", "1\u{202f}234\u{a0}567"] {
            let expected = if text.contains('\u{a0}') { Err("") } else { Ok(1_234_567.0) };
            assert_eq!(inhabitants(text), expected, "{text}");
        }
        assert_eq!(
            (inhabitants("1,200"), inhabitants("19999.5"), inhabitants("1e3")),
            (Ok(1_200.0), Ok(19_999.5), Ok(1e3))
        );
        assert!(inhabitants("1.200").unwrap_err().contains("thousands"));
        assert_eq!(inhabitants("1200.125"), Ok(1200.125));
        for text in ["1,5", "1,200", "500,25", "1 200", "1.234.567"] {
            assert!(number(text).unwrap_err().contains("decimal point"), "{text}");
        }
        for text in ["", "many", "1,20,", ",", "1;2"] {
            assert!(number(text).is_err() && inhabitants(text).is_err(), "{text}");
        }
    }
}
