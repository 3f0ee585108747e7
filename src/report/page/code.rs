//! The code that a page carries: three.js and Chart.js, packed, and its own.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// A library: the name of its element, and its code, packed by gzip.
pub(super) const LIBRARIES: [(&str, &[u8]); 2] = [
    (
        "three",
        include_bytes!(concat!(env!("OUT_DIR"), "/three.min.js.gz")),
    ),
    (
        "chart",
        include_bytes!(concat!(env!("OUT_DIR"), "/chart.min.js.gz")),
    ),
];

/// The page around everything, with places `{{name}}` for what differs.
pub(super) const FRAME: &str = include_str!("page.html");
/// Style sheet of the page.
pub(super) const SHEET: &str = include_str!("page.css");
/// Scripts that all pages share.
const HELPERS: [&str; 2] = [include_str!("read.js"), include_str!("theme.js")];
/// The modules of the page of a run in the order in which they need each other.
pub(super) const MODULES: [&str; 10] = [
    include_str!("clock.js"),
    include_str!("camera.js"),
    include_str!("parts.js"),
    include_str!("picture.js"),
    include_str!("ground.js"),
    include_str!("scene.js"),
    include_str!("charts.js"),
    include_str!("answer.js"),
    include_str!("print.js"),
    include_str!("start.js"),
];

/// A page's own code: one function around helpers and modules.
pub(super) fn script(modules: &[&str]) -> String {
    let (helpers, modules) = (HELPERS.concat(), modules.concat());
    format!("(() => {{\n\"use strict\";\n{helpers}{modules}}})();\n")
}

/// The elements of the libraries, which the page unpacks.
pub(super) fn libraries() -> String {
    let element = |(name, code): (&str, &[u8])| {
        let text = STANDARD.encode(code);
        format!("<script type=\"application/gzip\" id=\"library-{name}\">{text}</script>\n")
    };
    LIBRARIES.map(element).concat()
}
