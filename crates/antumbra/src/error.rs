//! What can be wrong with bytes or parameters.

/// Why bytes are not a usable `.antumbra` file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The magic number is missing.
    #[error("not an .antumbra file: it does not begin with the bytes \"ANTUMBRA\"")]
    NotAntumbra,
    /// A later format.
    #[error(
        "the file has format version {major}.{minor}; this program reads version 2: update the program or bake again"
    )]
    Version {
        /// The file's major version.
        major: u16,
        /// The file's minor version.
        minor: u16,
    },
    /// The file is shorter or longer than it says.
    #[error(
        "the file is cut off or has grown: it should hold {expected} bytes but holds {found}; copy or bake it again"
    )]
    Length {
        /// Bytes that the header states.
        expected: u64,
        /// Bytes that are there.
        found: u64,
    },
    /// A checksum does not match.
    #[error("the file is damaged: the checksum of its {part} does not match; copy or bake it again")]
    Checksum {
        /// Which part.
        part: &'static str,
    },
    /// A section that must be understood is not.
    #[error("the file needs a section of kind {kind:?} that this program does not know: update the program")]
    UnknownSection {
        /// The section's four-letter kind.
        kind: [u8; 4],
    },
    /// A section is missing.
    #[error("the file has no {0} section; bake it again")]
    MissingSection(&'static str),
    /// A value that no writer of this format would make.
    #[error("the file is malformed: {0}; bake it again")]
    Malformed(&'static str),
    /// An encoding that this program does not read.
    #[error("light {light} uses node encoding {encoding}, which this program does not know: update the program")]
    UnknownEncoding {
        /// Index of the light.
        light: usize,
        /// The encoding's number.
        encoding: u32,
    },
}

/// Why a filter cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a filter of {taps} x {taps} taps: the side must be odd, from 1 to 17")]
pub struct FilterError {
    /// Taps per side that were asked for.
    pub taps: u32,
}
