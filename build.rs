//! Finds Ipopt, translates the few declarations of its C header that `src/ipopt/ffi.rs` calls, and notes the versions that
//! results name.

use std::env;
use std::path::PathBuf;
use std::process::Command;

/// What is told when Ipopt or its header is missing.
const INSTALL: &str = "proboscis needs Ipopt with its C header: \
    install coinor-libipopt-dev (Debian, Ubuntu), coin-or-Ipopt-devel (Fedora) or ipopt (Homebrew), \
    and see that `pkg-config --cflags --libs ipopt` answers";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=PKG_CONFIG_PATH");

    // Only the shared library is linked: what it needs itself (LAPACK, MUMPS, Fortran) is its own affair,
    // so the rest of the list that pkg-config gives is left out.
    let Ok(ipopt) = pkg_config::Config::new()
        .cargo_metadata(false)
        .probe("ipopt")
    else {
        println!("cargo::error={INSTALL}");
        return;
    };
    let holds_ipopt = |path: &&PathBuf| {
        ["so", "dylib"]
            .iter()
            .any(|end| path.join(format!("libipopt.{end}")).exists())
    };
    for path in ipopt.link_paths.iter().filter(holds_ipopt) {
        println!("cargo::rustc-link-search=native={}", path.display());
    }
    println!("cargo::rustc-link-lib=dylib=ipopt");
    println!("cargo::rustc-env=PROBOSCIS_IPOPT={}", ipopt.version);
    if env::var("PROFILE").as_deref() == Ok("release") {
        note_commit();
    }

    let bindings = bindgen::Builder::default()
        .header_contents("ipopt.h", "#include <IpStdCInterface.h>\n")
        .clang_args(ipopt.include_paths.iter().map(|path| format!("-I{}", path.display())))
        .allowlist_function("(Create|Free)IpoptProblem|AddIpopt(Str|Num|Int)Option|SetIntermediateCallback|IpoptSolve")
        // Up to 3.13 `Bool` is `int`, since 3.14 it is `bool`: the callbacks are written in terms of the name.
        .allowlist_type("Bool")
        .rust_edition(bindgen::RustEdition::Edition2024)
        .layout_tests(false)
        .generate_comments(false)
        .generate();
    match bindings {
        Ok(bindings) => {
            let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
            bindings
                .write_to_file(out.join("ipopt.rs"))
                .expect("OUT_DIR can be written");
        }
        Err(error) => println!("cargo::error={INSTALL} ({error})"),
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
