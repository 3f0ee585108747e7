//! Sweeps on a HyperQueue server. A script stands for the command `hq`: it does the tasks of a job when they are submitted, and
//! counts them. `tests/cluster/hyperqueue` runs the real one.

use crate::runs::{proboscis, read, run, workshop};
use serde_json::json;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;

/// Keeps the name of its job, how its tasks ended, and a line for each task that it did. It is deaf to questions about tasks
/// while there is a file `deaf`, and absent while there is a file `absent`. While there is a file `early`, a stop seems to have kept the results
/// from better ones.
const SERVER: &str = r#"#!/bin/sh
here=$(dirname "$0")
failed() { printf '%s\n' '{"error": "nobody there\n\nStack backtrace:\n   0: main"}'; exit 1; }
[ ! -e "$here/absent" ] || failed
shift 2
case "$1 $2" in
"job list")
    [ -e "$here/name" ] || { echo '[]'; exit; }
    echo "[{\"id\": 7, \"name\": \"$(cat "$here/name")\"}]" ;;
"task list")
    [ ! -e "$here/deaf" ] || failed
    echo "{\"$3\": [$(cat "$here/tasks")]}" ;;
submit*)
    while [ "$1" != -- ]; do
        case "$1" in
        --name) echo "$2" > "$here/name" ;;
        --each-line) lines=$2 ;;
        --stderr) told=$2 ;;
        esac
        shift
    done
    shift
    number=0
    while IFS= read -r HQ_ENTRY; do
        export HQ_ENTRY
        echo "$HQ_ENTRY" >> "$here/done"
        if "$@" > /dev/null 2> "$(echo "$told" | sed "s/%{TASK_ID}/$number/")" < /dev/null; then
            echo "$comma{\"id\": $number, \"state\": \"finished\"}"
        else
            echo "$comma{\"id\": $number, \"state\": \"failed\", \"error\": \"Program terminated with exit code $?.\"}"
        fi
        comma=,
        number=$((number + 1))
    done < "$lines" > "$here/tasks"
    [ ! -e "$here/early" ] || sed -i 's/"code": "[a-z_]*"/"code": "stopped_early"/' "$here/../it's out/variants/"*/summary.json
    echo '{"id": 7}' ;;
*) failed ;;
esac
"#;

/// A folder `path with 'quotes'` with a sweep of two variants, of which one has too few iterations, and the server in `bin`.
fn prepare(folder: &Path) {
    let bin = folder.join("bin");
    fs::create_dir(&bin).unwrap();
    fs::write(bin.join("hq"), SERVER).unwrap();
    fs::set_permissions(bin.join("hq"), fs::Permissions::from_mode(0o755)).unwrap();
    let sweep = json!({
        "problem": "problems/pair.json",
        "set": { "control.intervals": 8 },
        "vary": { "control.solver.max_iterations": [100, 2] }
    });
    fs::write(folder.join("sweep.json"), sweep.to_string()).unwrap();
}

/// Exit status, standard output and standard error of the sweep with the server.
fn sweep(folder: &Path) -> (i32, String, String) {
    let path = format!("{}:/usr/bin:/bin", folder.join("bin").display());
    let output = proboscis(folder)
        .args([
            "sweep",
            "sweep.json",
            "--engine",
            "hyperqueue",
            "-o",
            "it's out",
        ])
        .env("PATH", path)
        .output()
        .unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let status = output.status.code().unwrap();
    (status, text(output.stdout), text(output.stderr))
}

/// Tasks that the server did.
fn tasks(folder: &Path) -> usize {
    let lines = fs::read_to_string(folder.join("bin/done"));
    lines.map_or(0, |lines| lines.lines().count())
}

#[test]
fn tasks_of_a_server_are_collected() {
    let folder = workshop();
    let folder = folder.path();
    prepare(folder);
    let (status, out, err) = sweep(folder);
    assert!(
        status == 0 && out.contains("1 iteration_limit, 1 solved"),
        "{out}{err}"
    );
    assert_eq!(tasks(folder), 2);
    assert!(!folder.join("it's out/hyperqueue").exists());
    let (status, out, err) = sweep(folder);
    assert!(
        status == 0 && out.contains("2 found solved before"),
        "{out}{err}"
    );
    assert_eq!(tasks(folder), 2);

    // The same files as in threads.
    run(folder, &["sweep", "sweep.json", "-o", "threads"]);
    let mut compared = 0;
    for variant in fs::read_dir(folder.join("it's out/variants")).unwrap() {
        let variant = variant.unwrap();
        let other = folder.join("threads/variants").join(variant.file_name());
        let [own, other] = [variant.path(), other].map(|path| {
            let seconds = read(path.join("summary.json"))["seconds"]["total"].as_f64();
            assert!(seconds.unwrap() > 0.0);
            fs::read(path.join("solution.json")).unwrap()
        });
        assert!(own == other);
        compared += 1;
    }
    assert_eq!(compared, 2);
}

#[test]
fn a_job_that_lost_its_client_is_collected_and_not_done_again() {
    let folder = workshop();
    let folder = folder.path();
    prepare(folder);
    let deaf = folder.join("bin/deaf");
    fs::write(&deaf, "").unwrap();
    let (status, out, err) = sweep(folder);
    assert!(
        status == 1
            && err.contains("nobody there; the same command goes on")
            && !err.contains("backtrace"),
        "{out}{err}"
    );
    assert_eq!(tasks(folder), 2);
    assert!(folder.join("it's out/hyperqueue/job.json").exists());
    fs::remove_file(&deaf).unwrap();
    let (status, out, err) = sweep(folder);
    assert!(
        status == 0 && out.contains("1 iteration_limit, 1 solved"),
        "{out}{err}"
    );
    assert_eq!(tasks(folder), 2);

    // A server that does not know the job gets what is left: a variant whose files are whole is not made again.
    fs::write(&deaf, "").unwrap();
    fs::remove_dir_all(folder.join("it's out")).unwrap();
    assert_eq!(sweep(folder).0, 1);
    assert_eq!(tasks(folder), 4);
    let mut variants = fs::read_dir(folder.join("it's out/variants")).unwrap();
    fs::remove_dir_all(variants.next().unwrap().unwrap().path()).unwrap();
    fs::write(folder.join("bin/name"), "another job").unwrap();
    fs::remove_file(&deaf).unwrap();
    assert_eq!(sweep(folder).0, 0);
    assert_eq!(tasks(folder), 5);
}

/// A server that is killed and begins again from its journal has lost the end of some tasks, and hands them out once more.
#[test]
fn a_task_that_is_handed_out_again_does_nothing() {
    let folder = workshop();
    let folder = folder.path();
    prepare(folder);
    assert_eq!(sweep(folder).0, 0);
    let lines = fs::read_to_string(folder.join("bin/done")).unwrap();
    let variants: Vec<_> = fs::read_dir(folder.join("it's out/variants"))
        .unwrap()
        .map(|one| one.unwrap().path())
        .collect();
    let written = || {
        let of = |file: &str| {
            let paths = variants.iter().map(|variant| variant.join(file));
            let times = paths.map(|path| fs::metadata(path).unwrap().modified().unwrap());
            times.collect::<Vec<_>>()
        };
        [of("summary.json"), of("solution.json")]
    };
    let again = || {
        for line in lines.lines() {
            let mut task = std::process::Command::new("sh");
            let task = task.args(["-c", "eval \"exec $HQ_ENTRY\""]);
            let ended = task.env("HQ_ENTRY", line).current_dir(folder).output();
            let ended = ended.unwrap();
            let told = String::from_utf8(ended.stdout).unwrap();
            // The exit status is that of the first time: one of the two has too few iterations.
            let expected = if told.contains("iteration limit") {
                1
            } else {
                0
            };
            assert_eq!(ended.status.code(), Some(expected), "{told}");
        }
    };
    let before = written();
    again();
    assert_eq!(written(), before);
    let (_, out, _) = sweep(folder);
    assert!(out.contains("2 found solved before"), "{out}");

    // What was killed in the middle is done.
    fs::remove_file(variants[0].join("solution.json")).unwrap();
    again();
    let after = written();
    assert!(after[0][0] > before[0][0] && after[0][1] == before[0][1]);
}

#[test]
fn a_missing_server_is_told_before_anything_is_written() {
    let folder = workshop();
    let folder = folder.path();
    prepare(folder);
    fs::write(folder.join("bin/absent"), "").unwrap();
    let (status, _, err) = sweep(folder);
    assert!(
        status == 2
            && err.contains("--engine hyperqueue: no server")
            && err.contains("(nobody there)"),
        "{err}"
    );
    fs::remove_file(folder.join("bin/hq")).unwrap();
    let (status, _, err) = sweep(folder);
    assert!(
        status == 2 && err.contains("expected the command \"hq\""),
        "{err}"
    );
    assert!(!folder.join("it's out").exists());
}

/// Results that a stop kept from better ones are solved again, whatever their status is.
#[test]
fn variants_that_a_stop_left_acceptable_are_solved_again() {
    let folder = workshop();
    let folder = folder.path();
    prepare(folder);
    fs::write(folder.join("bin/early"), "").unwrap();
    let (_, out, err) = sweep(folder);
    assert!(out.contains("1 iteration_limit, 1 solved"), "{out}{err}");
    let variants = fs::read_dir(folder.join("it's out/variants")).unwrap();
    let mut summaries = variants.map(|one| read(one.unwrap().path().join("summary.json")));
    let is_early = |summary: &serde_json::Value| {
        summary["status"] == "solved" && summary["notes"][0]["code"] == "stopped_early"
    };
    assert!(summaries.any(|summary| is_early(&summary)));
    fs::remove_file(folder.join("bin/early")).unwrap();
    for found in ["1 found solved before", "2 found solved before"] {
        let (status, out, err) = sweep(folder);
        assert!(
            status == 0 && out.contains("1 iteration_limit, 1 solved"),
            "{out}{err}"
        );
        assert!(out.contains(found), "{out}{err}");
        assert_eq!(tasks(folder), 3);
    }
}
