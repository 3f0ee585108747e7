//! Sections and figures of `results/gallery/hard_cases.md`.
//!
//! The page is its own store: a case replaces its section, conclusion and list at the top are made anew from all sections that stand.

use proboscis::report::atomic;
use proboscis::report::axes::Axis;
use proboscis::report::lines::{LinePlot, Series};
use proboscis::report::origin::Origin;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Every case, in the order of the page.
const CASES: [&str; 40] = [
    "voltage-from-zero",
    "pull-in-lumped",
    "pull-in-lumped-motion",
    "pull-in-elements",
    "pull-in-elements-motion",
    "pull-in-distorted",
    "collapse-under-weight",
    "stretch-static",
    "stretch-dynamic",
    "singular-length",
    "singular-length-start",
    "singular-length-control",
    "nearly-incompressible",
    "nearly-incompressible-bending",
    "mass-ratio",
    "stiffness-ratio",
    "viscosity-none-to-huge",
    "step-too-large",
    "steps-between",
    "long-undamped-trunk",
    "long-constraints",
    "revolutions",
    "forty-bodies",
    "singular-arm-parallel",
    "singular-arm-aligned",
    "singular-arm-straight",
    "redundant-loop",
    "redundant-joint",
    "one-interval",
    "two-thousand-intervals",
    "free-time-bounds",
    "unreachable-goal",
    "duplicated-muscles",
    "similar-systems",
    "other-units",
    "warm-start",
    "potentials-between-electrodes",
    "pendulum-by-others",
    "nothing-at-all",
    "same-run-twice",
];

/// Cases whose outcome is words alone.
const WITHOUT_FIGURE: [&str; 1] = ["same-run-twice"];

/// Verdict on a case.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Verdict {
    /// The answer is right.
    Answer,
    /// There is no answer, and the program says why.
    Refusal,
    /// Right answers as far as there are any, refusals beyond.
    Both,
}

impl Verdict {
    fn words(self) -> &'static str {
        match self {
            Self::Answer => "right answer",
            Self::Refusal => "explained refusal",
            Self::Both => "right answer, and an explained refusal beyond it",
        }
    }
}

/// A case that was computed and whose law holds.
#[derive(Debug)]
pub(crate) struct Case {
    /// Its name among all cases, and that of its figure.
    pub(crate) name: &'static str,
    /// Title of section and figure.
    pub(crate) title: &'static str,
    /// Law that must hold.
    pub(crate) law: &'static str,
    pub(crate) verdict: Verdict,
    /// Observations: numbers, or the words of a refusal.
    pub(crate) seen: Vec<String>,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) curves: Vec<Series>,
}

/// Tests of one process write one after the other.
static PAGE: Mutex<()> = Mutex::new(());

fn results() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("results/gallery")
}

impl Case {
    /// Writes figure and section, where that is asked for.
    pub(crate) fn record(mut self) {
        assert!(
            CASES.contains(&self.name),
            "{} is no case of the page",
            self.name
        );
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        assert!(points().count() != 1, "{}: nothing to draw", self.name);
        assert!(
            points().flatten().all(|x| x.is_finite()),
            "{}: a point of the figure is not finite",
            self.name
        );
        if std::env::var_os("PROBOSCIS_WRITE_PAGES").is_none() {
            return;
        }
        let folder = results();
        let figures = folder.join("hard_cases");
        fs::create_dir_all(&figures).unwrap();
        let mut section = format!(
            "## {}\n\nLaw: {}\n\nVerdict: {}.\n\n",
            self.title,
            self.law,
            self.verdict.words()
        );
        for line in &self.seen {
            section.push_str(&format!("* {line}\n"));
        }
        // What a figure cannot show has none.
        if !self.curves.is_empty() {
            section.push_str(&format!(
                "\n![{}](hard_cases/{}.svg)\n",
                self.title, self.name
            ));
            self.draw(&figures);
        }

        let guard = PAGE.lock().unwrap_or_else(|broken| broken.into_inner());
        let path = folder.join("hard_cases.md");
        let old = fs::read_to_string(&path).unwrap_or_default();
        let mut all = sections(&old);
        all.insert(self.name.to_owned(), section);
        atomic::write(&path, page(&all).as_bytes()).unwrap();
        drop(guard);
    }
}

impl Case {
    /// Writes the figure.
    fn draw(&mut self, folder: &Path) {
        let [x, y] = [&self.x, &self.y].map(Clone::clone);
        let plot = LinePlot {
            title: self.title.to_owned(),
            ..LinePlot::new(x, y, std::mem::take(&mut self.curves))
        };
        let origin = Origin {
            command: format!("cargo test --test hard, case {}", self.name),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            ..Origin::default()
        };
        let figure = folder.join(format!("{}.svg", self.name));
        atomic::write(&figure, plot.svg(&origin).as_bytes()).unwrap();
    }
}

/// Text before the name of a section.
const MARK: &str = "<a id=\"";

/// The sections of a page by name.
fn sections(page: &str) -> BTreeMap<String, String> {
    let parts = page.split(MARK).skip(1);
    let section = |part: &str| {
        let (name, text) = part.split_once("\"></a>\n\n")?;
        Some((name.to_owned(), format!("{}\n", text.trim_end())))
    };
    parts.filter_map(section).collect()
}

/// Returns the rest of a line of a section after its start.
fn line<'a>(section: &'a str, start: &str) -> &'a str {
    let found = section.lines().find_map(|line| line.strip_prefix(start));
    found.unwrap_or_default().trim_end_matches('.')
}

/// Returns the numbers of cases by their ends, in a sentence.
fn conclusion<'a>(sections: impl Iterator<Item = (&'a &'static str, &'a String)>) -> String {
    let verdicts: Vec<&str> = sections.map(|(_, text)| line(text, "Verdict: ")).collect();
    let count = |verdict: Verdict| verdicts.iter().filter(|v| **v == verdict.words()).count();
    format!(
        "**Conclusion.** The asserted properties of all {} cases hold: {} end with the right answer, {} with right answers as far as there are any \
         and an explained refusal beyond, {} with an explained refusal.\n\n",
        verdicts.len(),
        count(Verdict::Answer),
        count(Verdict::Both),
        count(Verdict::Refusal)
    )
}

/// The page of sections, with a list of their verdicts at the top.
fn page(sections: &BTreeMap<String, String>) -> String {
    let mut text = "# Hard cases\n\n\
        Each case asserts its law in `tests/hard`; `make studies` writes this page. A run that is refused says why, in one line,\n\
        and leaves no number in its files that is not finite.\n\n"
        .to_owned();
    let known = || {
        CASES
            .iter()
            .filter_map(|name| Some((name, sections.get(*name)?)))
    };
    text.insert_str(
        text.find("Each case").expect("the first sentence"),
        &conclusion(known()),
    );
    text.push_str("| case | verdict |\n|:--|:--|\n");
    for (name, section) in known() {
        text.push_str(&format!(
            "| [{}](#{name}) | {} |\n",
            line(section, "## "),
            line(section, "Verdict: ")
        ));
    }
    for (name, section) in known() {
        text.push_str(&format!("\n{MARK}{name}\"></a>\n\n{section}"));
    }
    text
}

#[test]
fn the_kept_page_has_every_case_and_its_figure() {
    let kept = fs::read_to_string(results().join("hard_cases.md")).unwrap();
    let guard = PAGE.lock().unwrap_or_else(|broken| broken.into_inner());
    let all = sections(&kept);
    for name in CASES {
        let section = all.get(name).unwrap_or_else(|| panic!("no section {name}"));
        let figure = format!("hard_cases/{name}.svg");
        let is_there = results().join(&figure).is_file();
        assert_eq!(section.contains(&figure), is_there, "figure {name}");
        assert_eq!(is_there, !WITHOUT_FIGURE.contains(&name), "figure {name}");
    }
    assert_eq!(all.len(), CASES.len());
    assert_eq!(page(&all), kept);
    drop(guard);
}
