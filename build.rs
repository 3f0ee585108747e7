//! Finds Ipopt, the MUMPS it was linked with and the code of pages, chooses the declarations in `src/ipopt` that agree with the header of Ipopt,
//! compiles what knows the structure of MUMPS, and notes the versions that results name.

use std::collections::BTreeSet;
use std::env;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Message when Ipopt or its header is missing.
const INSTALL: &str = "proboscis needs Ipopt with its C header: \
    install coinor-libipopt-dev (Debian, Ubuntu), coin-or-Ipopt-devel (Fedora) or ipopt (Homebrew), \
    and see that `pkg-config --cflags --libs ipopt` answers";
/// Versions of Ipopt that brought a C interface; `make bindings` makes `src/ipopt/bindings_*` from their headers.
const INTERFACES: [&str; 2] = ["3_11", "3_14"];

/// Message when MUMPS or its header is missing.
const INSTALL_MUMPS: &str = "proboscis needs the MUMPS that Ipopt uses, with its C header `dmumps_c.h`: \
    install libmumps-seq-dev and libmumps-headers-dev (Debian 12, Ubuntu), libmumps-dev (Debian 13) or MUMPS-devel (Fedora)";
/// Name of the library where neither Ipopt nor pkg-config tells it.
const MUMPS: &str = "dmumps_seq";
/// Folders of `dmumps_c.h` besides those of Ipopt and those that the compiler knows.
const MUMPS_HEADERS: [&str; 3] = [
    "/usr/include/MUMPS",
    "/usr/include/mumps-seq",
    "/usr/local/include/mumps",
];

/// Environment variable of a folder with files of JavaScript, in addition to those of the system.
const JAVASCRIPT: &str = "PROBOSCIS_JAVASCRIPT";
/// The code that pages carry, below the folders of [`JAVASCRIPT_FOLDERS`].
const CODE: [&str; 2] = ["three/three.min.js", "chart.js/chart.min.js"];
/// Folders in which Debian installs it.
const JAVASCRIPT_FOLDERS: [&str; 2] = ["/usr/share/javascript", "/usr/local/share/javascript"];
/// Message when the code of pages is missing.
const INSTALL_JAVASCRIPT: &str = "proboscis puts three.js and Chart.js into the pages that it writes: \
    install libjs-three and libjs-chart.js (Debian, Ubuntu), or take three@0.111 and chart.js@3.9 from npm \
    and let PROBOSCIS_JAVASCRIPT name the folder that has them as";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if env::var_os("CARGO_FEATURE_REPORT").is_some() {
        pack_code();
    }
    println!("cargo::rerun-if-env-changed=PKG_CONFIG_PATH");
    if let Err(missing) = libraries() {
        println!("cargo::error={missing}");
    }
    if env::var("PROFILE").as_deref() == Ok("release") {
        note_commit();
    }
}

/// Links Ipopt and MUMPS, and compiles what depends on their headers; an error says what is missing.
///
/// Only the shared libraries are linked: what they need themselves (LAPACK, Fortran) is their own affair, so the rest of the list that
/// pkg-config gives is left out.
fn libraries() -> Result<(), String> {
    let ipopt = pkg_config::Config::new()
        .cargo_metadata(false)
        .probe("ipopt")
        .map_err(|_| INSTALL)?;
    println!("cargo::rustc-env=PROBOSCIS_IPOPT={}", ipopt.version);
    let library = Library::find("ipopt", &ipopt.link_paths).ok_or(INSTALL)?;
    library.link();
    choose_bindings(&ipopt)?;

    let told = ipopt.libs.iter().find(|name| name.contains("mumps"));
    let told = told.map_or(MUMPS, String::as_str);
    let mut needed = library.needs.clone();
    let mumps = if library.has_mumps {
        library
    } else {
        let mut folders = ipopt.link_paths;
        folders.extend(library.path.parent().map(Path::to_owned));
        let name = library.mumps().unwrap_or(told);
        let mumps = Library::find(name, &folders);
        let mumps = mumps.ok_or_else(|| format!("{INSTALL_MUMPS} (no library {name})"))?;
        mumps.link();
        needed.extend(mumps.needs.clone());
        mumps
    };
    if needed.iter().any(|file| is_mpi(file)) {
        println!("cargo::rustc-cfg=mpi");
    }
    compile_instance(ipopt.include_paths, &mumps)
}

/// A shared library that is linked.
struct Library {
    name: String,
    path: PathBuf,
    /// True if it is the one that the linker finds by itself.
    is_found: bool,
    /// Files of the libraries that it needs.
    needs: Vec<String>,
    /// True if it contains MUMPS.
    has_mumps: bool,
}

impl Library {
    /// In one of these folders, or where the linker finds it by itself.
    fn find(name: &str, folders: &[PathBuf]) -> Option<Self> {
        let known = linker_finds(name);
        let near = folders
            .iter()
            .flat_map(|folder| shared(name).map(|file| folder.join(file)))
            .find(|path| path.exists());
        let path = near.or_else(|| known.clone())?;
        let is_found = known.is_some_and(|known| is_one_file(&known, &path));
        let bytes = fs::read(&path).unwrap_or_default();
        let (needs, has_mumps) = read(&bytes).unwrap_or_default();
        let name = name.to_owned();
        Some(Self {
            name,
            path,
            is_found,
            needs,
            has_mumps,
        })
    }

    /// Tells cargo. The loader looks where the linker does, and does not know another folder unless the program names it.
    fn link(&self) {
        if let (Some(folder), false) = (self.path.parent(), self.is_found) {
            let folder = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
            println!("cargo::rustc-link-search=native={}", folder.display());
            println!("cargo::rustc-link-arg=-Wl,-rpath,{}", folder.display());
        }
        println!("cargo::rustc-link-lib=dylib={}", self.name);
        // Another version may have another header.
        println!("cargo::rerun-if-changed={}", self.path.display());
    }

    /// Folders of headers of the same installation.
    fn headers(&self) -> Vec<PathBuf> {
        let include = self.path.parent().map(|folder| folder.join("../include"));
        let include = include.filter(|_| !self.is_found);
        let below = ["", "mumps", "mumps_seq", "coin-or/mumps", "MUMPS"];
        let place = |include: PathBuf| below.map(|folder| include.join(folder));
        include.into_iter().flat_map(place).collect()
    }

    /// The MUMPS that it needs: `dmumps` of `libdmumps-5.7.so`, `coinmumps` of `libcoinmumps.so.3`.
    fn mumps(&self) -> Option<&str> {
        let mut names = self.needs.iter().filter_map(|file| file_stem(file));
        names.find(|name| name.contains("mumps"))
    }
}

/// The name that the linker is given for a file such as `libdmumps_seq-5.5.so` or `/opt/lib/libcoinmumps.3.dylib`.
fn file_stem(file: &str) -> Option<&str> {
    let file = file.rsplit('/').next()?.strip_prefix("lib")?;
    file.split(['-', '.']).next()
}

/// Returns true if a file is a library of MPI, of which `libmpiseq` only has the names.
fn is_mpi(file: &str) -> bool {
    let name = file_stem(file).unwrap_or_default();
    name == "mpi" || name.starts_with("mpi_") || name.starts_with("mpich")
}

/// Returns the libraries that a shared library needs, and true if it contains MUMPS; none of a file that cannot be read.
fn read(bytes: &[u8]) -> Option<(Vec<String>, bool)> {
    let own = |libraries: &[&str]| libraries.iter().map(|&file| file.to_owned()).collect();
    if let Ok(elf) = goblin::elf::Elf::parse(bytes) {
        let has_mumps = elf.dynsyms.iter().any(|symbol| {
            let is_defined = !symbol.is_import() && symbol.st_value != 0;
            is_defined && elf.dynstrtab.get_at(symbol.st_name) == Some("dmumps_c")
        });
        return Some((own(&elf.libraries), has_mumps));
    }
    let library = goblin::mach::MachO::parse(bytes, 0).ok()?;
    let exports = library.exports().ok()?;
    let has_mumps = exports.iter().any(|export| export.name == "_dmumps_c");
    Some((own(&library.libs), has_mumps))
}

/// Chooses the declarations that agree with the header of Ipopt: in C, from which those in Rust were made too, they compile after it.
fn choose_bindings(ipopt: &pkg_config::Library) -> Result<(), String> {
    let build = |interface: &str| {
        let declarations = format!("src/ipopt/bindings_{interface}.c");
        println!("cargo::rerun-if-changed={declarations}");
        let mut build = cc::Build::new();
        build.file(declarations).includes(&ipopt.include_paths);
        build.cargo_metadata(false).cargo_warnings(false);
        build
    };
    let missing = build(INTERFACES[0]).try_expand();
    missing.map_err(|error| format!("{INSTALL} ({error})"))?;
    let agrees = |interface: &&str| build(interface).try_compile_intermediates().is_ok();
    let chosen = INTERFACES.into_iter().find(agrees).ok_or_else(|| {
        let known = INTERFACES.join(" nor that of ").replace('_', ".");
        format!(
            "IpStdCInterface.h of Ipopt {} declares a C interface that is neither that of Ipopt {known}: \
            src/ipopt/bindings_*.c do not compile after it",
            ipopt.version
        )
    })?;
    println!("cargo::rustc-cfg=ipopt_{chosen}");
    Ok(())
}

/// Compiles the functions that know the structure of MUMPS, with the header of the one that is linked.
fn compile_instance(mut folders: Vec<PathBuf>, mumps: &Library) -> Result<(), String> {
    const INSTANCE: &str = "src/sparse/mumps/instance.c";
    println!("cargo::rerun-if-changed={INSTANCE}");
    let beside: Vec<PathBuf> = folders.iter().map(|folder| folder.join("mumps")).collect();
    folders.extend(beside);
    folders.extend(mumps.headers());
    folders.extend(MUMPS_HEADERS.map(PathBuf::from));
    let mut build = cc::Build::new();
    build.file(INSTANCE).includes(folders);
    let compiled = build.try_compile("proboscis_mumps");
    compiled.map_err(|error| format!("{INSTALL_MUMPS} ({error})"))?;
    let expanded = build.cargo_metadata(false).try_expand();
    let expanded = expanded.map_err(|error| format!("{INSTALL_MUMPS} ({error})"))?;
    check_version(&expanded, mumps)
}

/// Compares the version of `dmumps_c.h` in the preprocessed functions with those that the library names; the program compares again when it
/// runs, with what MUMPS then says of itself, so that a library which names none passes here.
fn check_version(expanded: &[u8], mumps: &Library) -> Result<(), String> {
    let header = series(expanded);
    let library = series(&fs::read(&mumps.path).unwrap_or_default());
    if library.is_empty() || header.iter().any(|version| library.contains(version)) {
        return Ok(());
    }
    let [header, library] = [header, library].map(|versions| Vec::from_iter(versions).join(", "));
    Err(format!(
        "dmumps_c.h is the header of MUMPS {header}, but {} is MUMPS {library}: \
        a folder that `pkg-config --cflags ipopt` names, or `mumps` in it, has to hold the header of that MUMPS",
        mumps.path.display()
    ))
}

/// Versions of MUMPS in these bytes, such as `5.8` of a text `5.8.2`.
fn series(bytes: &[u8]) -> BTreeSet<String> {
    let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'.';
    let version = |word: &[u8]| {
        let text = str::from_utf8(word).ok()?;
        let mut numbers = text.split('.');
        let [major, minor, patch] = [numbers.next()?, numbers.next()?, numbers.next()?];
        let is_number = |text: &str| matches!(text.parse::<u8>(), Ok(0..=99));
        let is_one = major == "5" && is_number(minor) && is_number(patch);
        (is_one && numbers.next().is_none()).then(|| format!("{major}.{minor}"))
    };
    bytes
        .split(|byte| !is_part(byte))
        .filter_map(version)
        .collect()
}

/// Packs the code of pages for `src/report/page/code.rs`.
fn pack_code() {
    println!("cargo::rerun-if-env-changed={JAVASCRIPT}");
    let named = env::var_os(JAVASCRIPT).map(PathBuf::from);
    let folders = named
        .into_iter()
        .chain(JAVASCRIPT_FOLDERS.map(PathBuf::from));
    let folders: Vec<PathBuf> = folders.collect();
    for file in CODE {
        let place = folders.iter().map(|folder| folder.join(file));
        let Some(path) = place.into_iter().find(|path| path.is_file()) else {
            println!("cargo::error={INSTALL_JAVASCRIPT} {}", CODE.join(" and "));
            return;
        };
        println!("cargo::rerun-if-changed={}", path.display());
        let code = fs::read(&path).expect("a file that is there can be read");
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        packed.write_all(&code).expect("memory can be written");
        let packed = packed.finish().expect("memory can be written");
        let name = path.file_name().expect("the path of a file has a name");
        let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
        fs::write(out.join(name).with_extension("js.gz"), packed).expect("OUT_DIR can be written");
    }
}

/// Returns true if both paths lead to the same file.
fn is_one_file(one: &Path, other: &Path) -> bool {
    fs::canonicalize(one).ok() == fs::canonicalize(other).ok()
}

/// Names of the files of a shared library.
fn shared(name: &str) -> impl Iterator<Item = String> {
    ["so", "dylib"]
        .map(|end| format!("lib{name}.{end}"))
        .into_iter()
}

/// Returns the path at which the linker finds a shared library by itself: `cc` then prints its path instead of repeating its name.
fn linker_finds(name: &str) -> Option<PathBuf> {
    let place = |file: String| {
        let argument = format!("-print-file-name={file}");
        let output = Command::new("cc").arg(argument).output().ok()?;
        let path = PathBuf::from(String::from_utf8(output.stdout).ok()?.trim());
        path.is_absolute().then_some(path)
    };
    shared(name).find_map(place)
}

/// Tells release builds from a checkout their commit; a development build would be compiled anew after each commit.
fn note_commit() {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        output.status.success().then(|| text.trim().to_owned())
    };
    if let Some(commit) = git(&["rev-parse", "--short=12", "HEAD"]) {
        println!("cargo::rustc-env=PROBOSCIS_COMMIT={commit}");
    }
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]) {
        println!("cargo::rerun-if-changed={log}");
    }
}
