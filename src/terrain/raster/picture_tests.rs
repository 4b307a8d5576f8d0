//! Pictures as rasters: PNG and GeoTIFF.

use super::{Band, GeoUnits, Holes, PngPlace, Raster};
use ::png::{BitDepth, ColorType, Encoder};
use ::tiff::encoder::{TiffEncoder, TiffValue, colortype};
use ::tiff::tags::Tag;
use glam::DVec2;
use proptest::prelude::*;
use std::io::Cursor;

const PLACE: PngPlace = PngPlace { corner: DVec2::ZERO, step: DVec2::splat(4.0), black: -100.0, white: 3000.0 };

fn picture(width: u32, height: u32, colour: ColorType, bits: BitDepth, data: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, width, height);
    encoder.set_color(colour);
    encoder.set_depth(bits);
    encoder.write_header().unwrap().write_image_data(data).unwrap();
    file
}

fn sixteen() -> Vec<u8> {
    let data: Vec<u8> = [0u16, 65_535, 32_768, 1, 2, 3].iter().flat_map(|v| v.to_be_bytes()).collect();
    picture(3, 2, ColorType::Grayscale, BitDepth::Sixteen, &data)
}

fn error(file: &[u8]) -> String {
    Raster::from_png("h.png", file, Band::Height, Holes::Refuse, PLACE).unwrap_err().reason
}

#[test]
fn grey_is_height_and_the_first_row_is_north() {
    let raster = Raster::from_png("h.png", &sixteen(), Band::Height, Holes::Refuse, PLACE).unwrap();
    assert_eq!((raster.value(0, 1), raster.value(1, 1)), (Some(-100.0), Some(3000.0)));
    assert!((raster.value(2, 0).unwrap() - (3.0 / 65_535.0 * 3100.0 - 100.0)).abs() < 1e-4);
    let eight = picture(2, 2, ColorType::Grayscale, BitDepth::Eight, &[0, 255, 51, 0]);
    let mask = PngPlace { black: 0.0, white: 1.0, ..PLACE };
    let raster = Raster::from_png("m.png", &eight, Band::Vegetation, Holes::Refuse, mask).unwrap();
    assert_eq!((raster.value(1, 1), raster.value(0, 0)), (Some(1.0), Some(0.2)));
}

#[test]
fn grey_comes_in_every_kind_of_picture() {
    let mask = PngPlace { black: 0.0, white: 1.0, ..PLACE };
    let read = |file: &[u8], holes| Raster::from_png("m.png", file, Band::Vegetation, holes, mask).unwrap();
    let expected = read(&picture(2, 2, ColorType::Grayscale, BitDepth::Eight, &[0, 255, 255, 0]), Holes::Refuse);
    let wide = |bytes: &[u8]| bytes.iter().flat_map(|b| [*b, *b]).collect::<Vec<u8>>();
    let rgb = [0, 0, 0, 255, 255, 255, 255, 255, 255, 0, 0, 0];
    let rgba = [0, 0, 0, 255, 255, 255, 255, 255, 255, 255, 255, 255, 0, 0, 0, 255];
    for (colour, bits, data) in [
        (ColorType::Rgb, BitDepth::Eight, rgb.to_vec()),
        (ColorType::Rgb, BitDepth::Sixteen, wide(&rgb)),
        (ColorType::Rgba, BitDepth::Eight, rgba.to_vec()),
        (ColorType::GrayscaleAlpha, BitDepth::Eight, vec![0, 255, 255, 255, 255, 255, 0, 255]),
        (ColorType::Grayscale, BitDepth::One, vec![0b0100_0000, 0b1000_0000]),
        (ColorType::Grayscale, BitDepth::Four, vec![0x0f, 0xf0]),
    ] {
        assert_eq!(read(&picture(2, 2, colour, bits, &data), Holes::Refuse), expected, "{colour:?} {bits:?}");
    }
    let mut palette = Vec::new();
    let mut encoder = Encoder::new(&mut palette, 2, 2);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Two);
    encoder.set_palette(vec![255, 255, 255, 0, 0, 0]);
    encoder.write_header().unwrap().write_image_data(&[0b0100_0000, 0b0001_0000]).unwrap();
    assert_eq!(read(&palette, Holes::Refuse), expected);
    // Transparent pixels have no value.
    let file = picture(2, 2, ColorType::GrayscaleAlpha, BitDepth::Eight, &[9, 0, 255, 255, 255, 255, 99, 0]);
    let filled = read(&file, Holes::Value(0.0));
    assert_eq!((&filled.values, filled.filled()), (&expected.values, 2));
    let refused = Raster::from_png("m.png", &file, Band::Vegetation, Holes::Refuse, mask).unwrap_err().reason;
    assert_eq!(refused, "2 of 4 cells have no vegetation density; fill them, or say how to fill them (`--fill`)");
}

#[test]
fn other_pictures_are_refused() {
    let colours = picture(2, 2, ColorType::Rgb, BitDepth::Eight, &[7, 7, 7, 1, 2, 3, 0, 0, 0, 0, 0, 0]);
    assert_eq!(error(&colours), "row 1, column 2 has the colour 1 2 3; allowed is grey: red, green and blue alike");
    let half = picture(2, 2, ColorType::GrayscaleAlpha, BitDepth::Eight, &[9, 255, 9, 255, 9, 128, 9, 0]);
    assert_eq!(error(&half), "row 2, column 1 is half transparent");
    let bits = picture(8, 2, ColorType::Grayscale, BitDepth::One, &[0xaa, 0x55]);
    assert_eq!(error(&bits), "the image has 1 bits; heights need 8, or better 16");
    assert!(error(&sixteen()[..60]).starts_with("not a readable PNG"));
    assert!(error(b"P5 2 2").starts_with("not a readable PNG"));
    let thin = picture(9, 1, ColorType::Grayscale, BitDepth::Eight, &[0; 9]);
    assert!(error(&thin).starts_with("size of the raster is 9 x 1"));
    let bad = |place| Raster::from_png("h.png", &sixteen(), Band::Height, Holes::Refuse, place).unwrap_err().reason;
    assert!(bad(PngPlace { white: f64::INFINITY, ..PLACE }).starts_with("height is inf"));
    assert!(bad(PngPlace { step: DVec2::ZERO, ..PLACE }).starts_with("width of a cell is 0"));
    // A header that claims more than the file can hold, with a checksum that fits.
    let mut liar = picture(8192, 8192, ColorType::Grayscale, BitDepth::Sixteen, &vec![0; 8192 * 8192 * 2]);
    liar.truncate(5000);
    assert!(error(&liar).starts_with("the file is truncated: 5000 bytes"), "{}", error(&liar));
}

/// Three columns and two rows of heights.
const HEIGHTS: [f32; 6] = [10.0, 20.0, 30.0, 40.0, 50.0, -7.5];

/// Tags of a TIFF: adds or replaces one.
type Tags<'a> = ::tiff::encoder::ImageEncoder<
    'a,
    &'a mut Cursor<Vec<u8>>,
    colortype::Gray32Float,
    ::tiff::encoder::TiffKindStandard,
>;

fn tag(image: &mut Tags<'_>, tag: Tag, value: impl TiffValue) {
    image.encoder().write_tag(tag, value).unwrap();
}

/// A GeoTIFF whose upper left corner lies at 1000,2000, with cells of 30 by 20.
fn geotiff(more: impl Fn(&mut Tags<'_>), heights: &[f32]) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut file).unwrap();
    let mut image = encoder.new_image::<colortype::Gray32Float>(3, 2).unwrap();
    tag(&mut image, Tag::ModelPixelScaleTag, &[30.0, 20.0, 0.0][..]);
    tag(&mut image, Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, 1000.0, 2000.0, 0.0][..]);
    more(&mut image);
    image.write_data(heights).unwrap();
    file.into_inner()
}

/// Geo keys with their values.
fn keys(image: &mut Tags<'_>, entries: &[(u16, u16)]) {
    let mut all = vec![1, 1, 0, entries.len() as u16];
    entries.iter().for_each(|(key, value)| all.extend([*key, 0, 1, *value]));
    tag(image, Tag::GeoKeyDirectoryTag, &all[..]);
}

#[test]
fn a_geotiff_says_where_it_lies_and_what_it_lacks() {
    let read = |file: &[u8], holes| Raster::from_geotiff("h.tif", file, Band::Height, holes);
    let (raster, units) =
        read(&geotiff(|i| keys(i, &[(1024, 1), (1025, 1), (3072, 25832)]), &HEIGHTS), Holes::Refuse).unwrap();
    assert_eq!(
        (raster.bounds().min, raster.step(), units),
        (DVec2::new(1000.0, 1960.0), DVec2::new(30.0, 20.0), GeoUnits::Metres)
    );
    assert_eq!((raster.value(0, 1), raster.value(2, 0)), (Some(10.0), Some(-7.5)));
    // Places of middles are half a cell off those of corners.
    let (point, units) = read(&geotiff(|i| keys(i, &[(1024, 2), (1025, 2)]), &HEIGHTS), Holes::Refuse).unwrap();
    assert_eq!((point.bounds().min, units), (DVec2::new(985.0, 1970.0), GeoUnits::Degrees));
    assert_eq!(read(&geotiff(|_| (), &HEIGHTS), Holes::Refuse).unwrap().1, GeoUnits::Unknown);
    for hole in [f32::NAN, -999.0, -32_768.0] {
        let mut heights = HEIGHTS;
        heights[1] = hole;
        let file = geotiff(|i| tag(i, Tag::GdalNodata, "-999"), &heights);
        let filled = read(&file, Holes::Value(3.0)).unwrap().0;
        assert_eq!((filled.value(1, 1), filled.filled()), (Some(3.0), 1), "{hole}");
        assert!(read(&file, Holes::Refuse).unwrap_err().reason.starts_with("1 of 6 cells have no height"));
    }
    let reason = |file: &[u8]| read(file, Holes::Refuse).unwrap_err().reason;
    for (entries, expected) in [
        (&[(1024, 1), (3072, 3857)][..], "those of web maps (EPSG:3857)"),
        (&[(1024, 1), (3076, 9003)], "its coordinates are not in metres"),
        (&[(1024, 1), (4099, 9002)], "its heights are not in metres"),
        (&[(1024, 3)], "kind of coordinates (3)"),
    ] {
        let found = reason(&geotiff(|i| keys(i, entries), &HEIGHTS));
        assert!(found.contains(expected), "{found}");
    }
    let mut high = HEIGHTS;
    high[5] = 1e9;
    assert!(reason(&geotiff(|_| (), &high)).starts_with("row 2, column 3: height is 1000000000"));
    let rotated = [30.0, 5.0, 0.0, 1000.0, 5.0, -20.0, 0.0, 2000.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    assert!(reason(&geotiff(|i| tag(i, Tag::ModelTransformationTag, &rotated[..]), &HEIGHTS)).contains("rotated"));
    let whole = geotiff(|_| (), &HEIGHTS);
    assert!(reason(&whole[..whole.len() / 2]).starts_with("not a readable TIFF"));
    assert!(reason(b"II*").starts_with("not a readable TIFF"));
    let mut colours = Cursor::new(Vec::new());
    TiffEncoder::new(&mut colours).unwrap().write_image::<colortype::RGB8>(2, 2, &[0; 12]).unwrap();
    assert_eq!(reason(colours.get_ref()), "the file has 3 bands; it must have one, of heights");
    let mut plain = Cursor::new(Vec::new());
    TiffEncoder::new(&mut plain).unwrap().write_image::<colortype::Gray8>(2, 2, &[0; 4]).unwrap();
    assert!(reason(plain.get_ref()).contains("does not say where it lies"));
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(
        bytes in prop::collection::vec(any::<u8>(), 0..200),
        at in any::<prop::sample::Index>(),
    ) {
        let _ = Raster::from_geotiff("h.tif", &bytes, Band::Height, Holes::Keep);
        let mut tif = geotiff(|_| (), &HEIGHTS);
        let start = at.index(tif.len());
        let end = (start + bytes.len() / 20).min(tif.len());
        tif.splice(start..end, bytes.iter().take(9).copied());
        let _ = Raster::from_geotiff("h.tif", &tif, Band::Height, Holes::Keep);
        let _ = Raster::from_png("h.png", &bytes, Band::Height, Holes::Refuse, PLACE);
        let mut file = sixteen();
        let at = at.index(file.len());
        file.splice(at..(at + bytes.len() / 20).min(sixteen().len()), bytes.iter().take(9).copied());
        let _ = Raster::from_png("h.png", &file, Band::Height, Holes::Refuse, PLACE);
    }
}
