//! Damaged files of every format: an error or a valid mesh, never a panic.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::io::{Format, ReadOptions, read};

use super::common::*;

/// Changes per sound file. Every reader sees every kind of change many times.
const ROUNDS: u64 = 3_000;

/// Sound files to damage.
fn seeds() -> Vec<(Format, Vec<u8>)> {
    let mut files: Vec<(Format, Vec<u8>)> = ways()
        .into_iter()
        .map(|(format, options)| (format, to_bytes(&grouped_box(), format, &options)))
        .collect();
    for name in [
        "wallhole.obj",
        "negative_indices.obj",
        "P.off",
        "comments.off",
        "two_objects_mixed_case_names.stl",
        "three_cubes.stl",
        "cube_binary_header_with_RN_newline.ply",
        "rgb_cube_with_primitives.gltf",
        "BoxInterleaved.glb",
        "nested-quantized.glb",
        "nested-draco.glb",
        #[cfg(feature = "threemf")]
        "vertex-colours.3mf",
    ] {
        let bytes = std::fs::read(fixture(name)).unwrap();
        files.push((Format::from_content(&bytes).unwrap(), bytes));
    }
    let strips =
        b"ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n\
        property list uchar float uv\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n\
        0 0 0 0\n1 0 0 1 5\n0 1 0 0\n0 0 1 0\n10 0 1 2 3 -1 0 2 1 3 -1\n";
    files.push((Format::Ply, strips.to_vec()));
    files
}

/// Numbers that readers trip over.
const WORDS: [&str; 24] = [
    "nan",
    "inf",
    "-inf",
    "1e999",
    "-1e999",
    "1e-999",
    "0",
    "-0",
    "-1",
    "1",
    "2",
    "255",
    "256",
    "65535",
    "65536",
    "2147483647",
    "2147483648",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "99999999999999999999999",
    "1e308",
    "-2147483648",
    "0.5",
];

fn damage(bytes: &mut Vec<u8>, others: &[(Format, Vec<u8>)], random: &mut ChaCha8Rng) {
    let length = bytes.len();
    if length < 8 {
        bytes.extend(b"8 bytes.");
        return;
    }
    let at = random.random_range(0..length);
    match random.random_range(0..10) {
        0 => bytes.truncate(at),
        1 => bytes[at] ^= 1 << random.random_range(0..8),
        2 => bytes[at] = random.random(),
        3 => {
            // A length field.
            let at = at.min(length - 4) & !3;
            let value: u32 = [u32::MAX, u32::MAX - 1, 1 << 31, 0, 1, 0x7fff_ffff][random.random_range(0..6)];
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        }
        4 => {
            // A number in binary.
            let at = at.min(length - 8);
            let value = [f64::NAN, f64::INFINITY, 1e308, -0.0, 5e-324][random.random_range(0..5)];
            if random.random() {
                bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
            } else {
                bytes[at..at + 4].copy_from_slice(&(value as f32).to_le_bytes());
            }
        }
        5 | 6 => {
            // A number in text: the word at this place.
            let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || b".+-".contains(byte);
            let start = bytes[..at].iter().rposition(|byte| !is_word(byte)).map_or(0, |i| i + 1);
            let end = bytes[at..].iter().position(|byte| !is_word(byte)).map_or(length, |i| at + i);
            let word = WORDS[random.random_range(0..WORDS.len())];
            bytes.splice(start..end, word.bytes());
        }
        7 => {
            // A piece of another file, or of this one.
            let other = &others[random.random_range(0..others.len())].1;
            let from = random.random_range(0..other.len());
            let to = random.random_range(from..=other.len().min(from + 200));
            bytes.splice(at..at, other[from..to].iter().copied());
        }
        8 => {
            let end = random.random_range(at..=length.min(at + 100));
            bytes.drain(at..end);
        }
        _ => {
            let end = random.random_range(at..=length.min(at + 100));
            let piece = bytes[at..end].to_vec();
            let to = random.random_range(0..length);
            bytes.splice(to..to, piece);
        }
    }
}

/// Says which file was being read when a test panics.
struct Case<'a>(Format, usize, u64, &'a [u8]);

impl Drop for Case<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            let shown = String::from_utf8_lossy(&self.3[..self.3.len().min(3000)]).into_owned();
            panic_note(&format!("{} file {} round {}:\n{shown}", self.0, self.1, self.2));
        }
    }
}

#[expect(clippy::print_stderr, reason = "a failing test says what failed")]
fn panic_note(note: &str) {
    eprintln!("{note}");
}

#[test]
fn damaged_files_give_an_error_or_a_valid_mesh() {
    let files = seeds();
    let (mut read_well, mut refused) = (0, 0);
    for (number, (format, bytes)) in files.iter().enumerate() {
        assert!(assert_error_or_valid(read(bytes, *format, &ReadOptions::new())), "file {number}");
        for round in 0..ROUNDS {
            let mut random = ChaCha8Rng::seed_from_u64(round << 8 | number as u64);
            let mut damaged = bytes.clone();
            for _ in 0..random.random_range(1..4) {
                damage(&mut damaged, &files, &mut random);
            }
            let _case = Case(*format, number, round, &damaged);
            if assert_error_or_valid(read(&damaged, *format, &ReadOptions::new())) {
                read_well += 1;
            } else {
                refused += 1;
            }
            if let Ok(detected) = Format::detect(None, &damaged) {
                assert_error_or_valid(read(&damaged, detected.format, &ReadOptions::new()));
            }
        }
    }
    // Both outcomes are exercised.
    assert!(read_well > 1_000 && refused > 1_000, "{read_well} {refused}");
}

#[test]
fn every_file_read_as_every_format() {
    for (_, bytes) in seeds() {
        for format in Format::ALL {
            assert_error_or_valid(read(&bytes, format, &ReadOptions::new()));
        }
    }
}

#[test]
fn every_prefix_of_every_file() {
    for (format, bytes) in seeds() {
        for length in 0..bytes.len().min(6_000) {
            assert_error_or_valid(read(&bytes[..length], format, &ReadOptions::new()));
        }
    }
}

#[test]
fn every_number_replaced_by_every_hostile_one() {
    // Not at random: each number of each small text file in turn, by 2^32 - 1, not a number, infinity and the rest.
    let mut tried = 0;
    for (format, bytes) in seeds() {
        let Ok(text) = std::str::from_utf8(&bytes) else { continue };
        if bytes.len() > 1_500 {
            continue;
        }
        let is_part = |byte: u8| byte.is_ascii_digit() || b"+-.eE".contains(&byte);
        let mut at = 0;
        while let Some(start) = text.as_bytes()[at..].iter().position(|&byte| byte.is_ascii_digit()) {
            let start = at + start;
            let end = text.as_bytes()[start..]
                .iter()
                .position(|&byte| !is_part(byte))
                .map_or(text.len(), |n| start + n);
            for word in WORDS {
                let damaged = [&text[..start], word, &text[end..]].concat();
                assert_error_or_valid(read(damaged.as_bytes(), format, &ReadOptions::new()));
                tried += 1;
            }
            at = end;
        }
    }
    assert!(tried > 10_000, "{tried}");
}

#[test]
fn every_bit_of_small_files_flipped() {
    let mut tried = 0;
    for (format, bytes) in seeds() {
        if bytes.len() > 1_700 {
            continue;
        }
        let mut damaged = bytes.clone();
        for bit in 0..8 * bytes.len() {
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert_error_or_valid(read(&damaged, format, &ReadOptions::new()));
            damaged[bit / 8] ^= 1 << (bit % 8);
            tried += 1;
        }
    }
    assert!(tried > 50_000, "{tried}");
}

#[test]
fn every_word_of_small_binary_files_at_its_largest() {
    let mut tried = 0;
    for (format, bytes) in seeds() {
        if bytes.len() > 5_000 || std::str::from_utf8(&bytes).is_ok() {
            continue;
        }
        for at in 0..bytes.len().saturating_sub(8) {
            for value in [
                &u32::MAX.to_le_bytes()[..],
                &0x7fff_ffffu32.to_be_bytes(),
                &f64::NAN.to_le_bytes(),
                &f32::INFINITY.to_le_bytes(),
            ] {
                let mut damaged = bytes.clone();
                damaged[at..at + value.len()].copy_from_slice(value);
                assert_error_or_valid(read(&damaged, format, &ReadOptions::new()));
                tried += 1;
            }
        }
    }
    assert!(tried > 10_000, "{tried}");
}
