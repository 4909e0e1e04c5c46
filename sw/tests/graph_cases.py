"""Graphs for the tests and the bench of the cuts: random ones and polar grids as the foveation makes them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from shared_data import SHARED_DATA

SEED_CAPACITY = 1 << 30  # exceeds everything that a node can carry


@dataclass
class FlowCase:
    """An undirected edge list with one capacity per direction, and the terminal capacities of every node."""

    name: str
    node_count: int
    edges: np.ndarray  # (edge_count, 2) int32
    forward: np.ndarray  # (edge_count,) int32: edges[:, 0] -> edges[:, 1]
    backward: np.ndarray  # (edge_count,) int32
    source: np.ndarray  # (node_count,) int32
    sink: np.ndarray  # (node_count,) int32
    subset: np.ndarray | None = None  # int32


def polar_edges(rings: int, sectors: int) -> np.ndarray:
    """Ring-major 4-connected polar grid, wrapped in angle; node 0 is the hub, joined to all of ring 0."""
    node = 1 + np.arange(rings * sectors).reshape(rings, sectors)
    hub = np.stack([np.zeros(sectors, int), node[0]], 1)
    along = np.stack([node.ravel(), np.roll(node, -1, 1).ravel()], 1)
    outward = np.stack([node[:-1].ravel(), node[1:].ravel()], 1)
    order = np.concatenate([hub, along, outward])
    return order[np.lexsort((order[:, 1], order[:, 0]))].astype(np.int32)


def grid_edges(height: int, width: int) -> np.ndarray:
    node = np.arange(height * width).reshape(height, width)
    right = np.stack([node[:, :-1].ravel(), node[:, 1:].ravel()], 1)
    down = np.stack([node[:-1].ravel(), node[1:].ravel()], 1)
    return np.concatenate([right, down]).astype(np.int32)


def log_polar_intensity(image: np.ndarray, rings: int, sectors: int) -> np.ndarray:
    """Mean intensity of every cell, the hub first; cells beyond the image repeat its border."""
    height, width = image.shape
    outer_px = np.hypot(height, width) / 2
    inner_px = 4.0
    edges_px = inner_px * (outer_px / inner_px) ** (np.arange(rings + 1) / rings)
    samples = 4
    radius = edges_px[:-1, None] + np.diff(edges_px)[:, None] * (np.arange(samples) + 0.5) / samples
    angle = 2 * np.pi * (np.arange(sectors * samples) + 0.5) / (sectors * samples)
    u = np.clip(width / 2 + radius.reshape(-1, 1) * np.cos(angle), 0, width - 1).astype(int)
    v = np.clip(height / 2 + radius.reshape(-1, 1) * np.sin(angle), 0, height - 1).astype(int)
    cells = image[v, u].reshape(rings, samples, sectors, samples).mean(axis=(1, 3))
    hub = image[height // 2 - 3 : height // 2 + 4, width // 2 - 3 : width // 2 + 4].mean()
    return np.concatenate([[hub], cells.ravel()])


def intensity_capacity(edges: np.ndarray, intensity: np.ndarray, largest: int = 1000) -> np.ndarray:
    """Gaussian affinity of the intensities, as integers in 1 .. largest."""
    difference = intensity[edges[:, 0]] - intensity[edges[:, 1]]
    return np.maximum(1, np.round(largest * np.exp(-((difference / 15.0) ** 2)))).astype(np.int32)


def synthetic_image(seed: int, height: int = 480, width: int = 640) -> np.ndarray:
    """Textured background with a few bright and dark rectangles."""
    rng = np.random.default_rng(seed)
    coarse = rng.normal(110, 30, (height // 40 + 1, width // 40 + 1))
    image = np.kron(coarse, np.ones((40, 40)))[:height, :width] + rng.normal(0, 6, (height, width))
    for _ in range(8):
        v, u = rng.integers(0, height - 60), rng.integers(0, width - 60)
        image[v : v + rng.integers(20, 160), u : u + rng.integers(10, 160)] = rng.uniform(0, 255)
    return np.clip(image, 0, 255)


def _polar_case(name: str, image: np.ndarray, rings: int, sectors: int) -> tuple[FlowCase, np.ndarray]:
    edges = polar_edges(rings, sectors)
    intensity = log_polar_intensity(image, rings, sectors)
    capacity = intensity_capacity(edges, intensity)
    empty = np.zeros(1 + rings * sectors, np.int32)
    case = FlowCase(name, empty.size, edges, capacity, capacity.copy(), empty.copy(), empty.copy())
    return case, intensity


def ring_seed_case(name: str, image: np.ndarray, rings: int = 67, sectors: int = 96) -> FlowCase:
    """S holds the hub and the first ring, T the outermost ring."""
    case, _ = _polar_case(f"{name}, ring seeds", image, rings, sectors)
    case.source[: 1 + sectors] = SEED_CAPACITY
    case.sink[-sectors:] = SEED_CAPACITY
    return case


def seed_case(name: str, image: np.ndarray, seed: int, rings: int = 67, sectors: int = 96) -> FlowCase:
    """Isolating cut: S holds one 3x3 seed, T eleven others."""
    case, _ = _polar_case(f"{name}, seeds", image, rings, sectors)
    rng = np.random.default_rng(seed)
    for k in range(12):
        ring, sector = rng.integers(1, rings - 1), rng.integers(sectors)
        for dr in (-1, 0, 1):
            for ds in (-1, 0, 1):
                v = 1 + (ring + dr) * sectors + (sector + ds) % sectors
                if case.source[v] == 0 and case.sink[v] == 0:
                    (case.source if k == 0 else case.sink)[v] = SEED_CAPACITY
    return case


def soft_terminal_case(name: str, image: np.ndarray, rings: int = 67, sectors: int = 96) -> FlowCase:
    """Every node is drawn to S or T by how bright it is."""
    case, intensity = _polar_case(f"{name}, soft terminals", image, rings, sectors)
    bias = np.round(8 * (intensity - np.median(intensity))).astype(np.int32)
    case.source[:] = np.maximum(bias, 0)
    case.sink[:] = np.maximum(-bias, 0)
    return case


def polar_cases(name: str, image: np.ndarray, seed: int) -> list[FlowCase]:
    return [ring_seed_case(name, image), seed_case(name, image, seed), soft_terminal_case(name, image)]


def real_images() -> list[tuple[str, Path]]:
    """Images of the shared test data; empty where it is absent."""
    patterns = (
        "kitti_odometry/sequences/00/image_0/*.png",
        "kitti2012/image_0/*_10.png",
        "middlebury/*/im2.*",
    )
    found = []
    for pattern in patterns:
        matches = sorted(SHARED_DATA.glob(pattern))
        chosen = matches[:: max(1, len(matches) // 3)][:3]
        found += [(str(path.relative_to(SHARED_DATA)), path) for path in chosen]
    return found


def _random_edges(rng: np.random.Generator) -> tuple[str, int, np.ndarray]:
    kind = rng.choice(["sparse", "grid", "polar", "path", "disconnected"])
    if kind == "grid":
        height, width = rng.integers(1, 12, 2)
        return kind, int(height * width), grid_edges(height, width)
    if kind == "polar":
        rings, sectors = rng.integers(1, 9), rng.integers(3, 13)
        return kind, int(1 + rings * sectors), polar_edges(rings, sectors)
    node_count = int(rng.integers(1, 60))
    if kind == "path":
        order = rng.permutation(node_count)
        return kind, node_count, np.stack([order[:-1], order[1:]], 1).astype(np.int32)
    density = rng.uniform(0, 4) if kind == "sparse" else rng.uniform(0, 0.9)
    edges = rng.integers(0, node_count, (int(density * node_count), 2))  # parallel edges occur
    return kind, node_count, edges[edges[:, 0] != edges[:, 1]].astype(np.int32)


def _random_terminals(rng: np.random.Generator, node_count: int, largest: int) -> np.ndarray:
    """Source and sink capacities, one row each."""
    kind = rng.choice(["seeds", "soft", "both", "one-sided"])
    source, sink = terminals = np.zeros((2, node_count), np.int32)
    if kind == "soft":
        drawn = rng.integers(0, 2, (2, node_count))
        source[:], sink[:] = drawn * rng.integers(0, largest + 1, (2, node_count))
    elif kind == "one-sided":
        source[:] = rng.integers(0, largest + 1, node_count)
    if kind in ("seeds", "both"):
        if kind == "both":
            source[:], sink[:] = rng.integers(0, largest + 1, (2, node_count))
        picked = rng.permutation(node_count)[: rng.integers(0, 5)]
        source[picked[::2]] = SEED_CAPACITY
        sink[picked[1::2]] = SEED_CAPACITY
    return terminals


def random_case(rng: np.random.Generator) -> FlowCase:
    """A small graph of random kind, capacities, terminals and subset; totals fit int32, as scipy needs."""
    kind, node_count, edges = _random_edges(rng)
    largest = int(rng.choice([1, 3, 100, (1 << 28) // (node_count + len(edges))]))
    forward, backward = rng.integers(0, largest + 1, (2, len(edges))).astype(np.int32)
    if rng.random() < 0.5:
        backward = forward.copy()
    keep = rng.random(len(edges)) > rng.choice([0, 0, 0.3, 1], p=[0.4, 0.2, 0.35, 0.05])
    source, sink = _random_terminals(rng, node_count, largest)
    case = FlowCase(kind, node_count, edges, forward * keep, backward * keep, source, sink)
    if rng.random() < 0.5:
        size = int(rng.integers(0, node_count + 1))
        case.subset = rng.permutation(node_count)[:size].astype(np.int32)
    return case
