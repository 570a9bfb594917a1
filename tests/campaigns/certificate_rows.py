"""Certificates as rows, one table for each vehicle, and as the columns that the kernel reads.

A row document is what a person would write by hand: vehicles by name, numbers as decimal texts, an interval as a list
of two, None where no limit is asked for. It shares no code with the producer of certificates.
"""

from __future__ import annotations

from decimal import Decimal
from typing import Any

from gaincert.verify import kernel

Document = dict[str, Any]

PARAMETERS = ("mass", "inertia", "half_track", "wheel_radius", "wheel_inertia")
SCALES = ("position_scale", "heading_scale")


def column(texts: list[str]) -> str:
    """Decimal texts in one column, all with the same places."""
    places = max((len(text.partition(".")[2]) for text in texts), default=0)
    padded = []
    for text in texts:
        whole, _, fraction = text.partition(".")
        padded.append(whole + ("." + fraction.ljust(places, "0") if places else ""))
    return " ".join(padded)


def texts(column: str) -> list[str]:
    """The decimal texts of a column."""
    return column.split(" ") if column else []


def uncertain(values: list[Any]) -> Any:
    """A column, or two where one of the values is an interval."""
    if not any(isinstance(value, list) for value in values):
        return column(values)
    ends = [value if isinstance(value, list) else [value, value] for value in values]
    return [column([low for low, _ in ends]), column([high for _, high in ends])]


def certain(value: Any) -> list[Any]:
    """The values of a column or of two."""
    if isinstance(value, str):
        return texts(value)
    return [[low, high] if low != high else low for low, high in zip(*map(texts, value), strict=True)]


def excitation_columns(table: Any) -> Any:
    if table is None or table["family"] != "harmonics":
        return table
    return {**table, "sin": column(table["sin"]), "cos": column(table["cos"])}


def excitation_rows(table: Any) -> Any:
    if table is None or table["family"] != "harmonics":
        return table
    return {**table, "sin": texts(table["sin"]), "cos": texts(table["cos"])}


def to_columns(rows: Document) -> Document:
    """The certificate of a row document."""
    fleet, gains = rows["fleet"], rows["gains"]
    vehicles = fleet["vehicle"]
    place = {vehicle["name"]: i for i, vehicle in enumerate(vehicles)}
    edges = sorted((*sorted((place[a], place[b])), weight) for a, b, weight in fleet["graph"]["edges"])
    led = sorted((place[name], weight) for name, weight in fleet["graph"]["leader_links"].items())
    limits: Document = {}
    for name in kernel.LIMITS:
        asked = [(str(i), v["limits"][name]) for i, v in enumerate(vehicles) if v["limits"].get(name) is not None]
        limits[name] = {"vehicle": " ".join(i for i, _ in asked), "value": column([value for _, value in asked])}
    designed = rows["designed"].get("graph")
    weights = None
    if designed is not None:
        own = {tuple(sorted((place[a], place[b]))): weight for a, b, weight in designed["edges"]}
        designed_led = {place[name]: weight for name, weight in designed["leader_links"].items()}
        weights = {
            "edges": column([own.get((i, j), "0") for i, j, _ in edges]),
            "leader_links": column([designed_led.get(i, "0") for i, _ in led]),
        }
    return {
        "schema": kernel.SCHEMA,
        "conditions": rows["conditions"],
        "fleet": {
            "drive": fleet["drive"],
            "vehicles": len(vehicles),
            **{name: uncertain([vehicle.get(name, "0") for vehicle in vehicles]) for name in PARAMETERS},
            **{f"torque_{side}": uncertain([v["torque_limit"][side] for v in vehicles]) for side in ("left", "right")},
            **{f"offset_{axis}": column([v["offset"][k] for v in vehicles]) for k, axis in enumerate("xy")},
            "limits": {name: table if table["vehicle"] else None for name, table in limits.items()},
            "edges": {
                "tail": " ".join(str(i) for i, _, _ in edges),
                "head": " ".join(str(j) for _, j, _ in edges),
                "weight": column([weight for _, _, weight in edges]),
            },
            "leader_links": {
                "vehicle": " ".join(str(i) for i, _ in led),
                "weight": column([weight for _, weight in led]),
            },
            "excitation": excitation_columns(fleet["excitation"]),
        },
        "designed": {"excitation": excitation_columns(rows["designed"].get("excitation")), "weights": weights},
        "gains": {name: column(values) for name, values in gains.items()},
        "psi_bar": rows["psi_bar"],
        "arcs": rows["arcs"],
        "tree": tree(rows["forest"], edges),
        "margins": {name: column([m for m in margins if m is not None]) for name, margins in rows["margins"].items()},
        "rim_speed": column([speed for speed in rows["rim_speed"] if speed is not None]),
        "rates": rows["rates"],
        "provenance": {},
    }


def tree(forest: list[list[int]], edges: list[tuple[int, int, str]]) -> dict[str, str]:
    """Links and depths from [vehicle, parent], -1 for the leader, parents first."""
    numbers = {(i, j): number for number, (i, j, _) in enumerate(edges)}
    link, depth = [""] * len(forest), [0] * len(forest)
    for vehicle, parent in forest:
        pair = (min(vehicle, parent), max(vehicle, parent))
        link[vehicle] = "-1" if parent < 0 else str(numbers[pair])
        depth[vehicle] = 0 if parent < 0 else depth[parent] + 1
    return {"link": " ".join(link), "depth": " ".join(map(str, depth))}


def to_rows(document: Document) -> Document:
    """The row document of a certificate that the kernel accepts; vehicles are named by their places."""
    fleet, count = document["fleet"], document["fleet"]["vehicles"]
    names = [f"v{i}" for i in range(count)]
    parameters = {name: certain(fleet[name]) for name in PARAMETERS}
    torque = {side: certain(fleet[f"torque_{side}"]) for side in ("left", "right")}
    offsets = list(zip(texts(fleet["offset_x"]), texts(fleet["offset_y"]), strict=True))
    asked = {name: of_vehicles(table, count) for name, table in fleet["limits"].items()}
    graph = graph_rows(fleet, fleet["edges"]["weight"], fleet["leader_links"]["weight"], names)
    designed: Document = {}
    if document["designed"]["excitation"] is not None:
        designed["excitation"] = excitation_rows(document["designed"]["excitation"])
    if document["designed"]["weights"] is not None:
        weights = document["designed"]["weights"]
        designed["graph"] = graph_rows(fleet, weights["edges"], weights["leader_links"], names)
    margins = {}
    for name, stated in document["margins"].items():
        if name in fleet["limits"]:
            margins[name] = of_vehicles({"vehicle": fleet["limits"][name]["vehicle"], "value": stated}, count)
        else:
            margins[name] = texts(stated)
    wheels = fleet["limits"]["wheel_speed"] or {"vehicle": ""}
    return {
        "schema": document["schema"],
        "conditions": document["conditions"],
        "fleet": {
            "drive": fleet["drive"],
            "excitation": excitation_rows(fleet["excitation"]),
            "graph": graph,
            "vehicle": [
                {
                    "name": names[i],
                    **{name: values[i] for name, values in parameters.items()},
                    "torque_limit": {side: values[i] for side, values in torque.items()},
                    "offset": list(offsets[i]),
                    "limits": {name: values[i] for name, values in asked.items()},
                }
                for i in range(count)
            ],
        },
        "designed": designed,
        "gains": {name: texts(values) for name, values in document["gains"].items()},
        "psi_bar": document["psi_bar"],
        "margins": margins,
        "rim_speed": of_vehicles({"vehicle": wheels["vehicle"], "value": document["rim_speed"]}, count),
        "rates": document["rates"],
    }


def of_vehicles(table: Any, count: int) -> list[str | None]:
    """An entry for every vehicle, None for those that are not listed."""
    if table is None:
        return [None] * count
    listed = dict(zip(map(int, texts(table["vehicle"])), texts(table["value"]), strict=True))
    return [listed.get(i) for i in range(count)]


def graph_rows(fleet: Document, weights: str, leader_weights: str, names: list[str]) -> Document:
    """Links by name, those of weight 0 left out."""
    ends = zip(*(map(int, texts(fleet["edges"][end])) for end in ("tail", "head")), texts(weights), strict=True)
    led = zip(map(int, texts(fleet["leader_links"]["vehicle"])), texts(leader_weights), strict=True)
    return {
        "edges": [[names[i], names[j], weight] for i, j, weight in ends if Decimal(weight)],
        "leader_links": {names[i]: weight for i, weight in led if Decimal(weight)},
    }
