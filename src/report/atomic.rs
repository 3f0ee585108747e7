//! Writing of a file whole or not at all.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use tempfile::NamedTempFile;

/// End of the name of a file that is being written: `.summary.json.Xy3fA9.partial`.
const PARTIAL: &str = ".partial";
/// A partial file that nobody wrote to for so long was left by a run that was killed.
const ABANDONED: Duration = Duration::from_secs(600);

/// A file that could not be written, and why.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {cause}", path.display())]
pub struct WriteError {
    /// The file or folder.
    pub path: PathBuf,
    /// Error of the operating system: no space left, permission denied, …
    pub cause: io::Error,
}

impl WriteError {
    /// Makes the error of a path from that of the operating system.
    pub(crate) fn at(path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |cause| Self { path, cause }
    }
}

/// Replaces `path` by `bytes` in one step: a reader sees the old file or the new one, never a part.
///
/// The bytes go to a partial file of the same folder, reach the disk, and take the name at last.
/// After a failure the old file is intact and the partial one gone. Only a process that is killed leaves it behind:
/// see [`tidy`].
///
/// # Errors
/// The file cannot be written.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    replace(path, bytes).map_err(WriteError::at(path))
}

fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let file = partial(path, bytes)?;
    file.as_file().sync_all()?;
    file.persist(path).map_err(|failure| failure.error)?;
    sync_folder(folder(path));
    Ok(())
}

/// The folder of a file.
pub(crate) fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Writes `bytes` to a partial file in the folder of `path`.
pub(super) fn partial(path: &Path, bytes: &[u8]) -> io::Result<NamedTempFile> {
    let mut hidden = OsString::from(".");
    hidden.push(path.file_name().unwrap_or_default());
    hidden.push(".");
    let mut builder = tempfile::Builder::new();
    builder.prefix(&hidden).suffix(PARTIAL);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As for any new file: the umask of the process narrows this down.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder(path))?;
    file.write_all(bytes)?;
    Ok(file)
}

/// A name is durable once the folder is; where folders cannot be synchronised it follows later.
pub(super) fn sync_folder(folder: &Path) {
    if let Ok(folder) = File::open(folder) {
        folder.sync_all().ok();
    }
}

/// Removes partial files that killed runs left in a folder more than ten minutes ago; younger ones may still be written.
pub fn tidy(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let age = entry
            .metadata()
            .and_then(|metadata| metadata.modified())
            .map(|written| written.elapsed().unwrap_or_default());
        let is_abandoned = age.is_ok_and(|age| age > ABANDONED);
        if name.starts_with('.') && name.ends_with(PARTIAL) && is_abandoned {
            fs::remove_file(entry.path()).ok();
        }
    }
}
