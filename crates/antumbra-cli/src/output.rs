//! What the program leaves behind: files that appear whole or not at all, and text on stdout and stderr.

use std::fs::{self, File, Permissions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

/// A file to be written at the end of a command.
pub struct OutputFile {
    /// As the user wrote it.
    name: PathBuf,
    /// With symbolic links resolved, so that a link to a file stays one.
    target: PathBuf,
    /// Devices and pipes are written to; they cannot be replaced.
    is_special: bool,
}

impl OutputFile {
    /// Checks, before any long work, that the file can be written.
    pub fn new(path: &Path) -> Result<Self> {
        let found = fs::metadata(path).ok();
        let shown = path.display();
        if found.as_ref().is_some_and(fs::Metadata::is_dir) || path.file_name().is_none() {
            bail!("cannot write {shown}: it is a folder; give a file's name");
        }
        let target = if found.is_some() { fs::canonicalize(path)? } else { path.to_owned() };
        let file = Self { name: path.to_owned(), target, is_special: found.is_some_and(|m| !m.is_file()) };
        let folder = file.folder();
        if !folder.is_dir() {
            bail!("cannot write {shown}: there is no folder {}; create it first", folder.display());
        }
        if !file.is_special {
            file.temporary().with_context(|| format!("cannot write {shown}"))?;
        }
        Ok(file)
    }

    /// Writes the whole file: beside it first, then in its place.
    pub fn write(&self, bytes: &[u8]) -> Result<()> {
        let written = if self.is_special { self.write_through(bytes) } else { self.replace(bytes) };
        written.map_err(|error| match error.kind() {
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
                let (size, name) = (bytes.len(), self.name.display());
                anyhow::anyhow!(
                    "cannot write the {size} bytes of {name}: {error}; free some space or choose another disk"
                )
            }
            _ => anyhow::Error::new(error).context(format!("cannot write {}", self.name.display())),
        })
    }

    fn write_through(&self, bytes: &[u8]) -> io::Result<()> {
        fs::OpenOptions::new().write(true).open(&self.target)?.write_all(bytes)
    }

    fn replace(&self, bytes: &[u8]) -> io::Result<()> {
        let mut beside = self.temporary()?;
        beside.write_all(bytes)?;
        beside.as_file().sync_all()?;
        beside.persist(&self.target).map_err(|e| e.error)?;
        // The name is as durable as the bytes where folders can be synced; elsewhere this fails and does not matter.
        let _ = File::open(self.folder()).and_then(|folder| folder.sync_all());
        Ok(())
    }

    fn folder(&self) -> &Path {
        match self.target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        }
    }

    /// A file beside the target that vanishes unless it is put in its place.
    fn temporary(&self) -> io::Result<tempfile::NamedTempFile> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".antumbra-").suffix(".part");
        let old = fs::metadata(&self.target).ok().map(|m| m.permissions());
        if let Some(permissions) = old.or_else(ordinary_permissions) {
            builder.permissions(permissions);
        }
        builder.tempfile_in(self.folder())
    }
}

/// What a new file may have before the user's mask is taken off; temporary files are private otherwise.
#[cfg(unix)]
fn ordinary_permissions() -> Option<Permissions> {
    Some(std::os::unix::fs::PermissionsExt::from_mode(0o666))
}

#[cfg(not(unix))]
fn ordinary_permissions() -> Option<Permissions> {
    None
}

/// Prints text to stdout. A reader that has gone away has read all that it wanted.
pub fn print(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error).context("cannot write to stdout"),
        _ => Ok(()),
    }
}

/// Prints a line to stderr; if nobody listens, nobody listens.
pub fn complain(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Prints warnings to stderr.
pub fn warn(warnings: &[String]) {
    for warning in warnings {
        complain(&format!("warning: {warning}"));
    }
}
