//! Reading files as text, with one tolerance for every reader.

use crate::layer::file::FileError;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The mark that some Windows programs put in front of UTF-8.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
/// How many bytes at the start of a file are searched for zeros, which text does not hold.
const LOOK_AT: usize = 1024;

/// Devices are read up to this size, in bytes: some never end (`/dev/zero`).
const LARGEST_DEVICE: u64 = 1 << 20;

/// Reads a whole file, but no more than `limit` bytes: an endless file (`/dev/zero`) or a huge one is refused instead of
/// filling the memory. Of a device no more than 1 MiB is read.
pub fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    let name = path.to_string_lossy();
    let failed = |e: std::io::Error| FileError::unreadable(&*name, e);
    let file = std::fs::File::open(path).map_err(failed)?;
    let metadata = file.metadata().map_err(failed)?;
    let limit = if is_device(&metadata) { limit.min(LARGEST_DEVICE) } else { limit };
    let too_large = || {
        let mib = limit >> 20;
        FileError::unreadable(&*name, format!("is larger than {mib} MiB, the most that is read"))
    };
    let length = metadata.len();
    if length > limit {
        return Err(too_large());
    }
    let mut content = Vec::with_capacity(length as usize);
    file.take(limit.saturating_add(1)).read_to_end(&mut content).map_err(failed)?;
    if content.len() as u64 > limit { Err(too_large()) } else { Ok(content) }
}

/// The text of a whole file of at most `limit` bytes: [`read_file`] and [`decode_text`].
pub fn read_text(path: &Path, limit: u64) -> Result<String, FileError> {
    let content = read_file(path, limit)?;
    Ok(decode_text(&path.to_string_lossy(), &content)?.to_owned())
}

#[cfg(unix)]
fn is_device(metadata: &std::fs::Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    let kind = metadata.file_type();
    kind.is_char_device() || kind.is_block_device()
}

#[cfg(not(unix))]
fn is_device(_: &std::fs::Metadata) -> bool {
    false
}

/// The `*.ron` files of a folder, sorted. Hidden files and those that editors leave while a file is open are not among them
/// ([`is_asset_file`]).
pub fn ron_files(folder: &Path) -> Result<Vec<PathBuf>, FileError> {
    let unreadable = |e: std::io::Error| FileError::unreadable(folder.to_string_lossy(), e);
    let entries = std::fs::read_dir(folder).map_err(unreadable)?;
    let mut files = entries.map(|e| e.map(|e| e.path())).collect::<Result<Vec<_>, _>>().map_err(unreadable)?;
    files.retain(|f| is_asset_file(f));
    files.sort();
    Ok(files)
}

/// Whether a file in a folder of assets is one: a `.ron` file that is not hidden (`.x.ron`), and no lock or copy of an editor
/// (`.#x.ron`, `~$x.ron`, `#x.ron#`, `x.ron~`, `x.ron.swp`).
pub fn is_asset_file(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("ron")) && !name.starts_with(['.', '~', '#'])
}

/// The text of a file, without the byte order mark that it may start with.
///
/// Line ends stay as they are: `\n` or `\r\n`. Text that is not UTF-8 is refused with the reason that is likely: another
/// encoding (UTF-16, UTF-32, Latin-1), or a compressed or binary file. `file` is the file's name for the error.
pub fn decode_text<'a>(file: &str, content: &'a [u8]) -> Result<&'a str, FileError> {
    if let Some(reason) = not_utf8(content) {
        return Err(FileError::unreadable(file, reason));
    }
    let text = content.strip_prefix(BYTE_ORDER_MARK).unwrap_or(content);
    std::str::from_utf8(text).map_err(|e| {
        let at = content.len() - text.len() + e.valid_up_to();
        let byte = content.get(at).copied().unwrap_or_default();
        FileError::at(file, content, at, format!("byte {byte:#04x} is not UTF-8; {}", likely_encoding(content, at)))
    })
}

/// What a file is instead of UTF-8, as far as its first bytes tell.
fn not_utf8(content: &[u8]) -> Option<&'static str> {
    const SIGNATURES: [(&[u8], &str); 8] = [
        (b"\xff\xfe\0\0", "is UTF-32 text; save it as UTF-8"),
        (b"\0\0\xfe\xff", "is UTF-32 text; save it as UTF-8"),
        (b"\xff\xfe", "is UTF-16 text; save it as UTF-8"),
        (b"\xfe\xff", "is UTF-16 text; save it as UTF-8"),
        (b"\x1f\x8b", "is compressed by gzip; unpack it first"),
        (b"BZh", "is compressed by bzip2; unpack it first"),
        (b"PK\x03\x04", "is a zip archive; unpack it first"),
        (b"\xfd7zXZ\0", "is compressed by xz; unpack it first"),
    ];
    let signature = SIGNATURES.into_iter().find(|(bytes, _)| content.starts_with(bytes));
    if let Some((_, reason)) = signature {
        return Some(reason);
    }
    let start = &content[..content.len().min(LOOK_AT)];
    let zeros = start.iter().filter(|b| **b == 0).count();
    // Every other byte of Western text in UTF-16 is zero.
    let zeros_of = |odd: usize| start.iter().skip(odd).step_by(2).filter(|b| **b == 0).count();
    match zeros {
        0 => None,
        _ if start.len() > 3 && (zeros_of(0) == 0 || zeros_of(1) == 0) && 3 * zeros > start.len() => {
            Some("is UTF-16 text without a byte order mark; save it as UTF-8")
        }
        _ => Some("is a binary file; allowed is text in UTF-8"),
    }
}

/// What to do about a byte at `at` that is not UTF-8.
fn likely_encoding(content: &[u8], at: usize) -> &'static str {
    // In Latin-1 a letter with an accent stands alone between ASCII letters.
    let is_ascii = |i: usize| content.get(i).is_none_or(u8::is_ascii);
    if is_ascii(at + 1) && (at == 0 || is_ascii(at - 1)) {
        "the file seems to be Latin-1 (Windows-1252): save it as UTF-8"
    } else {
        "save the file as UTF-8"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tolerance_and_refusal_of_text() {
        let utf16 = |text: &str, mark: &[u8]| -> Vec<u8> {
            mark.iter().copied().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect()
        };
        let refused = |content: &[u8]| decode_text("f", content).unwrap_err().to_string();
        for (content, text) in [
            (&b"a\nb"[..], "a\nb"),
            (b"\xef\xbb\xbfa", "a"),
            (b"\xef\xbb\xbf", ""),
            (b"", ""),
            (b"a\r\n", "a\r\n"),
            ("\u{ce}le".as_bytes(), "\u{ce}le"),
        ] {
            assert_eq!(decode_text("f", content), Ok(text));
        }
        for (content, reason) in [
            (utf16("<osm>", b"\xff\xfe"), "f: is UTF-16 text; save it as UTF-8"),
            (utf16("<osm>", b""), "f: is UTF-16 text without a byte order mark; save it as UTF-8"),
            (b"\xff\xfe\0\0a\0\0\0".to_vec(), "f: is UTF-32 text; save it as UTF-8"),
            (b"\x1f\x8b\x08".to_vec(), "f: is compressed by gzip; unpack it first"),
            (b"abc\0d".to_vec(), "f: is a binary file; allowed is text in UTF-8"),
            (
                b"x\ny \xcele".to_vec(),
                "f:2:3: byte 0xce is not UTF-8; the file seems to be Latin-1 (Windows-1252): save it as UTF-8",
            ),
            (b"\xef\xbb\xbf\n\xe2\x82 ".to_vec(), "f:2:1: byte 0xe2 is not UTF-8; save the file as UTF-8"),
        ] {
            assert_eq!(refused(&content), reason);
        }
    }

    #[test]
    fn a_file_beyond_the_limit_is_refused() {
        let path = std::env::temp_dir().join(format!("bevy_sprawl_limit_{}", std::process::id()));
        std::fs::write(&path, vec![b'x'; 2 << 20]).unwrap();
        assert_eq!(read_file(&path, 2 << 20).map(|c| c.len()), Ok(2 << 20));
        let error = read_file(&path, 1 << 20).unwrap_err();
        assert_eq!(error.reason, "is larger than 1 MiB, the most that is read");
        std::fs::remove_file(&path).unwrap();
        assert_eq!(read_file(&path, 9).unwrap_err().line, 0);
        let endless = Path::new("/dev/zero");
        if endless.exists() {
            let error = read_file(endless, u64::MAX).unwrap_err();
            assert_eq!(error.reason, "is larger than 1 MiB, the most that is read");
        }
        let empty = Path::new("/dev/null");
        assert!(!empty.exists() || read_text(empty, 9).is_ok_and(|text| text.is_empty()));
    }

    #[test]
    fn hidden_files_and_locks_of_editors_are_no_assets() {
        for name in ["a.ron", "A.RON", "a.b.ron", "x~.ron"] {
            assert!(is_asset_file(Path::new(name)), "{name}");
        }
        for name in [".a.ron", ".#a.ron", "~$a.ron", "#a.ron#", "a.ron~", ".a.ron.swp", ".DS_Store", "Thumbs.db", "ron"]
        {
            assert!(!is_asset_file(&Path::new("folder").join(name)), "{name}");
        }
    }
}
