//! Finds Ipopt, the MUMPS it was linked with and the code of pages, translates the few declarations of their C headers that `src/ipopt/ffi.rs`
//! and `src/sparse/mumps/ffi.rs` call, and notes the versions that results name.

use std::env;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What is told when Ipopt or its header is missing.
const INSTALL: &str = "proboscis needs Ipopt with its C header: \
    install coinor-libipopt-dev (Debian, Ubuntu), coin-or-Ipopt-devel (Fedora) or ipopt (Homebrew), \
    and see that `pkg-config --cflags --libs ipopt` answers";

/// What is told when MUMPS or its header is missing.
const INSTALL_MUMPS: &str = "proboscis needs the sequential MUMPS with its C header `dmumps_c.h`, the one that Ipopt uses: \
    install libmumps-seq-dev and libmumps-headers-dev (Debian, Ubuntu) or MUMPS-devel (Fedora)";
/// Name of the library where pkg-config does not tell what Ipopt was linked with.
const MUMPS: &str = "dmumps_seq";
/// Folders of `dmumps_c.h` besides those that the compiler knows.
const MUMPS_HEADERS: [&str; 3] = [
    "/usr/include/MUMPS",
    "/usr/include/mumps-seq",
    "/usr/local/include/mumps",
];

/// Where files of JavaScript may stand besides the places of the system.
const JAVASCRIPT: &str = "PROBOSCIS_JAVASCRIPT";
/// The code that pages carry, below the folders of [`JAVASCRIPT_FOLDERS`].
const CODE: [&str; 2] = ["three/three.min.js", "chart.js/chart.min.js"];
/// Where Debian installs it.
const JAVASCRIPT_FOLDERS: [&str; 2] = ["/usr/share/javascript", "/usr/local/share/javascript"];
/// What is told when the code of pages is missing.
const INSTALL_JAVASCRIPT: &str = "proboscis puts three.js and Chart.js into the pages that it writes: \
    install libjs-three and libjs-chart.js (Debian, Ubuntu), or take three@0.111 and chart.js@3.9 from npm \
    and let PROBOSCIS_JAVASCRIPT name the folder that has them as";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if env::var_os("CARGO_FEATURE_REPORT").is_some() {
        pack_code();
    }
    println!("cargo::rerun-if-env-changed=PKG_CONFIG_PATH");

    // Only the shared libraries are linked: what they need themselves (LAPACK, Fortran) is their own affair,
    // so the rest of the list that pkg-config gives is left out.
    let Ok(ipopt) = pkg_config::Config::new()
        .cargo_metadata(false)
        .probe("ipopt")
    else {
        println!("cargo::error={INSTALL}");
        return;
    };
    let mumps = ipopt.libs.iter().find(|name| name.contains("dmumps"));
    let mumps = mumps.map_or(MUMPS, String::as_str);
    for name in ["ipopt", mumps] {
        let holds = |path: &&PathBuf| shared(name).any(|file| path.join(file).exists());
        let folders: Vec<&PathBuf> = ipopt.link_paths.iter().filter(holds).collect();
        if name == mumps && folders.is_empty() && !linker_finds(name) {
            println!("cargo::error={INSTALL_MUMPS} (no library {name})");
            return;
        }
        for path in folders {
            println!("cargo::rustc-link-search=native={}", path.display());
        }
        println!("cargo::rustc-link-lib=dylib={name}");
    }
    println!("cargo::rustc-env=PROBOSCIS_IPOPT={}", ipopt.version);
    if env::var("PROFILE").as_deref() == Ok("release") {
        note_commit();
    }

    let ipopt_functions =
        "(Create|Free)IpoptProblem|AddIpopt(Str|Num|Int)Option|SetIntermediateCallback|IpoptSolve";
    let mut folders = ipopt.include_paths;
    // Up to 3.13 `Bool` is `int`, since 3.14 it is `bool`: the callbacks are written in terms of the name.
    let ipopt = bindings("IpStdCInterface.h", &folders, ipopt_functions).allowlist_type("Bool");
    write(ipopt, "ipopt.rs", INSTALL);
    folders.extend(MUMPS_HEADERS.map(PathBuf::from));
    write(
        bindings("dmumps_c.h", &folders, "dmumps_c"),
        "mumps.rs",
        INSTALL_MUMPS,
    );
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

/// Names of the files of a shared library.
fn shared(name: &str) -> impl Iterator<Item = String> {
    ["so", "dylib"]
        .map(|end| format!("lib{name}.{end}"))
        .into_iter()
}

/// Whether the linker finds a shared library by itself: `cc` then tells its place instead of repeating its name.
fn linker_finds(name: &str) -> bool {
    let is_told = |file: String| {
        let output = Command::new("cc")
            .arg(format!("-print-file-name={file}"))
            .output();
        output.is_ok_and(|output| {
            let path = String::from_utf8_lossy(&output.stdout);
            Path::new(path.trim()).is_absolute()
        })
    };
    shared(name).any(is_told)
}

/// Translates the functions of a header.
fn bindings(header: &str, folders: &[PathBuf], functions: &str) -> bindgen::Builder {
    bindgen::Builder::default()
        .header_contents("bindings.h", &format!("#include <{header}>\n"))
        .clang_args(folders.iter().map(|path| format!("-I{}", path.display())))
        .allowlist_function(functions)
        .rust_edition(bindgen::RustEdition::Edition2024)
        .layout_tests(false)
        .generate_comments(false)
}

/// Writes bindings to where the sources include them from.
fn write(bindings: bindgen::Builder, file: &str, install: &str) {
    match bindings.generate() {
        Ok(bindings) => {
            let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
            bindings
                .write_to_file(out.join(file))
                .expect("OUT_DIR can be written");
        }
        Err(error) => println!("cargo::error={install} ({error})"),
    }
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
