//! The order of equations and their unknowns of a bar.

use super::super::graph::Pattern;
use super::*;

#[test]
fn shuffled_equations_of_a_bar_come_near_the_diagonal() {
    // Equations 0..200 and unknowns 200..400 of a bar, five next to each other, known by numbers that tell nothing.
    const COUNT: u32 = 200;
    let shuffled = |i: u32| (i * 77 + 13) % COUNT;
    let near = |i: u32| i.saturating_sub(9)..COUNT.min(i + 10);
    let pairs = (0..COUNT).flat_map(|i| near(i).map(move |j| (shuffled(i), COUNT + shuffled(j))));
    let (rows, cols): (Vec<u32>, Vec<u32>) = pairs.unzip();
    let progress = &mut Progress::new(&|| false);
    let pattern = Pattern::new(&rows, &cols);
    let graph = Graph::new(2 * COUNT as usize, pattern, progress);
    let graph = graph.expect("nothing stops it");
    let before = Group {
        states: (COUNT..2 * COUNT).collect(),
        equations: (0..COUNT).collect(),
    };
    let mut groups = [before.clone()];
    arrange(&graph, &mut groups, progress).expect("nothing stops it");
    let envelope = |group: &Group| {
        let place = |list: &[u32], i| list.iter().position(|&j| j == i).expect("it is kept");
        let pairs = rows.iter().zip(&cols);
        let places = pairs.map(|(&i, &j)| (place(&group.equations, i), place(&group.states, j)));
        Envelope::new(COUNT as usize, COUNT as usize, places)
    };
    let (before, after) = (envelope(&before), envelope(&groups[0]));
    assert_eq!(before.stride, COUNT as usize);
    assert!(after.stride < 80, "{} rows at once", after.stride);
    assert!(
        4 * after.of_factors() < before.of_factors(),
        "{} multiplications, {} before",
        after.of_factors(),
        before.of_factors()
    );
}
