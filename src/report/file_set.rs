//! The files of one result, which take their names together, the summary last.
//!
//! Whoever finds the last file of a set finds all others as they were written with it: before the first of them takes its name, the last file
//! of an earlier result of the same folder is removed. Between the two, a kill or a loss of power leaves a folder without a summary.

use std::collections::BTreeSet;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{fs, thread};

use tempfile::NamedTempFile;

use crate::math::Stopped;
use crate::report::atomic::{self, WriteError};
use crate::stop::TimeLimit;

/// Files that are brought to the disk at a time: the disk then writes many of them at once.
const AT_ONCE: usize = 8;

/// Files that were written and wait for their names.
#[derive(Debug)]
pub struct FileSet {
    folder: PathBuf,
    written: Vec<(NamedTempFile, PathBuf)>,
    removed: Vec<PathBuf>,
    limit: Option<TimeLimit>,
}

impl FileSet {
    /// No file yet, of a folder that exists.
    pub fn in_folder(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            written: Vec::new(),
            removed: Vec::new(),
            limit: None,
        }
    }

    /// Makes every file that follows an error once this limit is reached.
    pub fn limit(&mut self, limit: &TimeLimit) {
        self.limit = Some(limit.clone());
    }

    /// Returns the number of files so far.
    pub fn count(&self) -> usize {
        self.written.len()
    }

    /// Keeps the first files alone, and removes the limit.
    pub fn truncate(&mut self, count: usize) {
        self.written.truncate(count);
        self.limit = None;
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Writes a file, named relative to the folder, without its name.
    ///
    /// # Errors
    /// It cannot be written, or the limit is reached; nothing of the set takes its name.
    pub fn add(&mut self, name: impl AsRef<Path>, bytes: &[u8]) -> Result<(), WriteError> {
        let path = self.folder.join(name);
        if self.limit.as_ref().and_then(TimeLimit::reached).is_some() {
            let cause = io::Error::other(Stopped);
            return Err(WriteError { path, cause });
        }
        match atomic::partial(&path, bytes) {
            Ok(file) => {
                self.written.push((file, path));
                Ok(())
            }
            Err(cause) => Err(WriteError { path, cause }),
        }
    }

    /// Writes a file where there is something to write; that of an earlier result goes otherwise.
    ///
    /// # Errors
    /// As of [`FileSet::add`].
    pub fn put(
        &mut self,
        name: impl AsRef<Path>,
        bytes: Option<impl AsRef<[u8]>>,
    ) -> Result<(), WriteError> {
        match bytes {
            Some(bytes) => return self.add(name, bytes.as_ref()),
            None => self.remove(name),
        }
        Ok(())
    }

    /// A file of an earlier result, which the set does not have.
    pub fn remove(&mut self, name: impl AsRef<Path>) {
        self.removed.push(self.folder.join(name));
    }

    /// Brings all files to the disk and gives them their names, that of the last one last.
    ///
    /// # Errors
    /// A file cannot be written. Before the first one takes its name nothing has changed.
    pub fn finish(mut self) -> Result<(), WriteError> {
        self.sync()?;
        let Some((last, last_path)) = self.written.pop() else {
            return Ok(());
        };
        let paths = self.written.iter().map(|(_, path)| path);
        let folders = paths.chain(&self.removed).map(|path| atomic::folder(path));
        let folders: BTreeSet<PathBuf> = folders.map(Path::to_owned).collect();
        if !folders.is_empty() && removed(&last_path)? {
            atomic::sync_folder(atomic::folder(&last_path));
        }
        for path in &self.removed {
            removed(path)?;
        }
        for (file, path) in self.written {
            file.persist(&path)
                .map_err(|failure| WriteError::at(path)(failure.error))?;
        }
        for folder in &folders {
            atomic::sync_folder(folder);
        }
        last.persist(&last_path)
            .map_err(|failure| WriteError::at(&last_path)(failure.error))?;
        atomic::sync_folder(atomic::folder(&last_path));
        Ok(())
    }

    /// Flushes the files to the disk.
    fn sync(&self) -> Result<(), WriteError> {
        let next = AtomicUsize::new(0);
        let work = || -> Result<(), WriteError> {
            while let Some((file, path)) = self.written.get(next.fetch_add(1, Ordering::Relaxed)) {
                file.as_file().sync_all().map_err(WriteError::at(path))?;
            }
            Ok(())
        };
        thread::scope(|scope| {
            let others = self.written.len().min(AT_ONCE).saturating_sub(1);
            let started = (0..others).map_while(|_| {
                let thread = thread::Builder::new();
                thread.spawn_scoped(scope, work).ok()
            });
            let started: Vec<_> = started.collect();
            let mine = work();
            let theirs = started.into_iter().map(|thread| {
                let gone = || io::Error::other("a thread of the writing ended");
                thread
                    .join()
                    .unwrap_or_else(|_| Err(WriteError::at(&self.folder)(gone())))
            });
            theirs.fold(mine, Result::and)
        })
    }
}

/// Removes a file; returns true if there was one.
fn removed(path: &Path) -> Result<bool, WriteError> {
    match fs::remove_file(path) {
        Ok(()) => Ok(true),
        Err(cause) if cause.kind() == ErrorKind::NotFound => Ok(false),
        Err(cause) => Err(WriteError::at(path)(cause)),
    }
}
