//! The wire format of protocol buffers, as far as OSM PBF uses it: fields of varints and of bytes.
//!
//! Messages are walked in place and nothing is built from them, so that a small file cannot ask for much memory.

/// The bytes are no protocol buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Malformed;

/// The value of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Value<'a> {
    Number(u64),
    Bytes(&'a [u8]),
}

impl<'a> Value<'a> {
    pub fn number(self) -> Option<u64> {
        if let Self::Number(n) = self { Some(n) } else { None }
    }

    pub fn bytes(self) -> Option<&'a [u8]> {
        if let Self::Bytes(bytes) = self { Some(bytes) } else { None }
    }
}

/// The fields of a message with their numbers, in order.
#[derive(Clone)]
pub(super) struct Fields<'a>(pub &'a [u8]);

impl<'a> Fields<'a> {
    /// The last value of a field, which is the one that counts.
    pub fn value(&self, number: u64) -> Option<Value<'a>> {
        self.clone().flatten().filter(|(n, _)| *n == number).last().map(|(_, value)| value)
    }

    /// The bytes of a field.
    pub fn bytes(&self, number: u64) -> &'a [u8] {
        self.value(number).and_then(Value::bytes).unwrap_or_default()
    }

    /// The number in a field.
    pub fn number(&self, number: u64) -> Option<u64> {
        self.value(number).and_then(Value::number)
    }

    fn read(&mut self) -> Option<(u64, Value<'a>)> {
        let key = varint(&mut self.0)?;
        let value = match key & 7 {
            0 => Value::Number(varint(&mut self.0)?),
            1 => Value::Bytes(self.take(8)?),
            2 => {
                let length = usize::try_from(varint(&mut self.0)?).ok()?;
                Value::Bytes(self.take(length)?)
            }
            5 => Value::Bytes(self.take(4)?),
            _ => return None,
        };
        Some((key >> 3, value))
    }

    fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some(taken)
    }
}

impl<'a> Iterator for Fields<'a> {
    type Item = Result<(u64, Value<'a>), Malformed>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.0.is_empty() {
            return None;
        }
        let field = self.read();
        if field.is_none() {
            self.0 = &[];
        }
        Some(field.ok_or(Malformed))
    }
}

/// Packed varints, up to the first that is cut off.
#[derive(Clone, Default)]
pub(super) struct Packed<'a>(pub &'a [u8]);

impl Packed<'_> {
    /// The sums of packed signed differences.
    pub fn sums(self) -> impl Iterator<Item = i64> {
        let mut sum = 0i64;
        self.map(move |n| {
            sum = sum.wrapping_add(signed(n));
            sum
        })
    }
}

impl Iterator for Packed<'_> {
    type Item = u64;

    fn next(&mut self) -> Option<u64> {
        varint(&mut self.0)
    }
}

/// A signed number whose sign is the last bit.
pub(super) fn signed(n: u64) -> i64 {
    (n >> 1) as i64 ^ -((n & 1) as i64)
}

fn varint(bytes: &mut &[u8]) -> Option<u64> {
    let mut value = 0u64;
    for i in 0..10 {
        let byte = *bytes.get(i)?;
        value |= u64::from(byte & 127) << (7 * i);
        if byte < 128 {
            *bytes = &bytes[i + 1..];
            return Some(value);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_numbers_and_what_is_cut_off() {
        let message = [8, 0x96, 1, 0x12, 2, 7, 8, 0x25, 1, 2, 3, 4, 8, 5];
        let fields: Result<Vec<_>, _> = Fields(&message).collect();
        let expected = [
            (1, Value::Number(150)),
            (2, Value::Bytes(&[7, 8])),
            (4, Value::Bytes(&[1, 2, 3, 4])),
            (1, Value::Number(5)),
        ];
        assert_eq!(fields, Ok(expected.to_vec()));
        assert_eq!((Fields(&message).number(1), Fields(&message).bytes(2)), (Some(5), &[7, 8][..]));
        for cut in [2, 4, 6, 9] {
            assert_eq!(Fields(&message[..cut]).value(9), None);
            assert!(Fields(&message[..cut]).any(|f| f.is_err()), "{cut}");
        }
        assert_eq!(Fields(&[0xff; 20]).collect::<Vec<_>>(), [Err(Malformed)]);
        assert_eq!(Packed(&[2, 1, 4, 0x80]).sums().collect::<Vec<_>>(), [1, 0, 2]);
        assert_eq!([0, 1, 2, u64::MAX].map(signed), [0, -1, 1, i64::MIN]);
    }
}
