"""The elephant trunk: six links, twelve muscles, from rest to rest in 0.3 s."""

import numpy as np

import proboscis as pb

X, Y, Z = np.eye(3)


def trunk(segments: int = 6) -> tuple[pb.System, list[pb.Muscle], pb.Marker]:
    """A chain of links with a pair of muscles at each joint."""
    system = pb.System("elephant trunk")
    silicone = system.add(
        pb.Material(
            "silicone", shear_modulus="100 kPa", lame_lambda="400 kPa", density="1000 kg/m^3",
            relative_permittivity=3.0, viscosity="1000 Pa s",
        )
    )  # fmt: skip
    below: pb.Body | str = pb.GROUND
    muscles = []
    for i in range(segments):
        base = 0.05 * i * Y
        link = system.add(
            pb.Body(mass="30 g", position=base + 0.025 * Y, cylinder={"length": "50 mm", "radius": "20 mm", "axis": Y})
        )
        axis, outwards = (Z, X) if i % 2 == 0 else (X, Z)
        system.add(pb.Joint(revolute={"axis": axis}, parent=below, child=link, at=base))
        for side in (outwards, -outwards):
            start, end = (pb.entries.Point(body=body, at=base + 0.015 * side + y * Y) for body, y in ((below, -0.02), (link, 0.02)))
            muscle = pb.Muscle(material=silicone, from_=start, to=end, cross_section=["10 mm", "10 mm"], layer_thickness="50 um")
            muscles.append(system.add(muscle))
        below = link
    tip = system.add(pb.Marker("tip", body=below, at=0.05 * segments * Y))
    return system, muscles, tip


def main() -> None:
    system, muscles, tip = trunk()
    problem = system.control(
        duration="0.3 s",
        intervals=125,
        start={"rest_at_voltages": {}},
        goal={"rest_at_voltages": {muscles[0]: "1.7 kV", muscles[2]: "1.6 kV"}},
        voltage_bounds=["0 V", "3 kV"],
        objective={"effort": 1.0, "rate": 0.0005},
        limits=[{"electric_field": {"muscles": "all", "max": "80 V/um"}}],
    )
    optimum = problem.solve()
    print(optimum)
    print("the tip ends at", optimum.position(tip)[-1], "m")
    print("highest voltage", max(optimum.voltage(muscle).max() for muscle in muscles), "V")


if __name__ == "__main__":
    main()
