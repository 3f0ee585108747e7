//! Results side by side: overlaid curves of the same quantity, and rows of their tables next to each other.

use serde_json::{Value, json};

use crate::report::origin::Origin;
use crate::report::page::page;
use crate::report::style;

/// Begin and end of the data of a page.
const DATA: [&str; 2] = [
    "<script type=\"application/json\" id=\"data\">",
    "</script>",
];

/// The data of a page that this program wrote; none where it is no such page, or not all of it.
pub fn data(html: &str) -> Option<Value> {
    html.trim_end().ends_with("</html>").then_some(())?;
    let (_, rest) = html.split_once(DATA[0])?;
    let (text, _) = rest.split_once(DATA[1])?;
    let data: Value = serde_json::from_str(text).ok()?;
    (data["charts"].is_array() && data["scenes"].is_array()).then_some(data)
}

/// The page of several results with their names, which lead to `pages` of their own where there are some.
pub fn html(results: &[(String, Value)], pages: &[String], origin: &Origin) -> String {
    let names: Vec<&str> = results.iter().map(|(name, _)| name.as_str()).collect();
    let of_each = |key: &str| -> Vec<&Value> { results.iter().map(|(_, one)| &one[key]).collect() };
    let scenes = scenes(results);
    let spans = scenes.iter().map(|scene| &scene["span"]);
    let end = |span: &Value| span[1].as_f64().unwrap_or(0.0);
    let data = json!({
        "title": "side by side",
        "system": names.join(", "),
        "names": names,
        "pages": pages,
        "colours": (0..results.len()).map(|r| style::hue(r).hex()).collect::<Vec<_>>(),
        "answers": of_each("answer"),
        "solved": of_each("isSolved"),
        "table": table(results),
        "span": spans.max_by(|a, b| end(a).total_cmp(&end(b))),
        "command": origin.command,
        "scenes": scenes,
        "charts": charts(results),
    });
    let title = format!("{}: side by side", names.join(", "));
    page(&title, origin, &data)
}

/// The motions of all results by the names of these, and by their own where a result has several; a path of equilibria has no time.
fn scenes(results: &[(String, Value)]) -> Vec<Value> {
    let of = |result: &(String, Value)| -> Vec<Value> {
        let (name, data) = result;
        let all = list(&data["scenes"]);
        let is_one = all.len() == 1;
        let named = all.filter(|scene| scene["span"].is_array()).map(|scene| {
            let mut scene = scene.clone();
            scene["name"] = match scene["name"].as_str() {
                Some(own) if !is_one => format!("{name}, {own}").into(),
                _ => name.as_str().into(),
            };
            scene
        });
        named.collect()
    };
    results.iter().flat_map(of).collect()
}

/// Rows of all tables, in the order in which they come first: the name, the value of each result.
fn table(results: &[(String, Value)]) -> Vec<Vec<String>> {
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (r, (_, data)) in results.iter().enumerate() {
        for [name, value] in rows_of(data) {
            let found = rows.iter().position(|row| row[0] == name);
            let at = found.unwrap_or_else(|| {
                rows.push(vec![String::new(); results.len() + 1]);
                rows.len() - 1
            });
            rows[at][0] = name;
            rows[at][r + 1] = value;
        }
    }
    rows
}

/// Names and values of the rows of a result; of several motions those of all, where they differ each with its own.
fn rows_of(data: &Value) -> Vec<[String; 2]> {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let of_one = data["rows"].as_array().into_iter().flatten();
    let of_one = of_one.map(|row| [text(&row[0]), text(&row[1])]);
    let of_several = data["table"].as_array().into_iter().flatten();
    let of_several = of_several.filter_map(|row| {
        let cells: Vec<String> = row.as_array()?.iter().map(text).collect();
        let (name, values) = cells.split_first()?;
        let are_one = values.iter().all(|value| *value == values[0]);
        let shown = match are_one {
            true => values.first()?.clone(),
            false => values.join(", "),
        };
        Some([name.clone(), shown])
    });
    of_one.chain(of_several).collect()
}

/// All charts; each quantity over time has a panel of its own, other plots keep theirs.
fn charts(results: &[(String, Value)]) -> Vec<Value> {
    let mut charts = Vec::new();
    for (r, (name, data)) in results.iter().enumerate() {
        for (chart, panel, series) in curves(data) {
            let is_over_time = chart["time"] == true;
            let of_chart = match (chart["of"].as_str(), &chart["title"]) {
                (Some(motion), Value::String(title)) => format!("{motion}: {title}").into(),
                (_, title) => title.clone(),
            };
            let title = if is_over_time {
                &series["name"]
            } else {
                &panel["title"]
            };
            let mut curve = series.clone();
            curve["colour"] = style::hue(r).hex().into();
            curve["name"] = match series["name"].as_str().unwrap_or_default() {
                _ if is_over_time => name.as_str().into(),
                "" => "".into(),
                own => format!("{name}, {own}").into(),
            };
            // Results are told apart by colour alone.
            curve["dashed"] = (!is_over_time && series["dashed"] == true).into();
            let shared = titled(
                &mut charts,
                json!({ "title": of_chart, "time": chart["time"], "kind": "panels", "panels": [] }),
            );
            let shared = titled(
                entries(&mut shared["panels"]),
                json!({ "title": title, "x": panel["x"], "y": panel["y"], "equal": panel["equal"], "series": [] }),
            );
            entries(&mut shared["series"]).push(curve);
        }
    }
    charts
}

/// The value of a list that has the title of a new one; the new one where there is none.
fn titled(list: &mut Vec<Value>, new: Value) -> &mut Value {
    let found = list.iter().position(|one| one["title"] == new["title"]);
    let place = found.unwrap_or(list.len());
    if found.is_none() {
        list.push(new);
    }
    &mut list[place]
}

fn entries(list: &mut Value) -> &mut Vec<Value> {
    list.as_array_mut().expect("it is a list")
}

fn list(value: &Value) -> std::slice::Iter<'_, Value> {
    value.as_array().map_or(&[][..], Vec::as_slice).iter()
}

/// All curves of a page with their charts and panels.
fn curves(data: &Value) -> impl Iterator<Item = (&Value, &Value, &Value)> {
    // Curves of parts of a disturbance are those of other motions.
    let charts = list(&data["charts"]).filter(|chart| chart["kind"] != "sizes");
    charts.flat_map(move |chart| {
        list(&chart["panels"])
            .flat_map(move |panel| list(&panel["series"]).map(move |series| (chart, panel, series)))
    })
}
