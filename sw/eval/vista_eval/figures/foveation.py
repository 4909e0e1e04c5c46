"""Figure 3: foveation. Left: the image. Middle: the graph of log-polar cells. Right: the foveated image."""

from __future__ import annotations

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from vista import parameters
from vista.chain import make_chain, run_frame

from vista_eval.cell_graph import OpenPipeline
from vista_eval.dataset.truth import FlightTruth
from vista_eval.figures.canvas import bare, show
from vista_eval.figures.moments import shown_frame
from vista_eval.fly import open_flight


def draw(truth: FlightTruth, values: parameters.Values) -> Figure:
    sequence = open_flight(truth.folder)
    chain = make_chain(sequence, "golden", values, threads=1)
    pipeline = OpenPipeline(chain.rectifier.calibration, values)
    step = run_frame(chain, sequence.frames[shown_frame(truth)])
    result = pipeline.process(
        step.frame.left, step.pair.levels, 0, step.frame.world_from_camera, sequence.up_world
    )
    graph = pipeline.cell_graph()
    height, width = step.frame.left.shape

    figure = Figure(figsize=(10.5, 2.9), layout="constrained")
    image_axes, graph_axes, foveated_axes = figure.subplots(1, 3)
    show(image_axes, step.frame.left, f"{width}x{height} pixels")
    graph_axes.add_collection(
        LineCollection(list(graph.cell_center_px[graph.edges]), colors="#1e3a5f", linewidths=0.25)
    )
    graph_axes.set(xlim=(-0.5, width - 0.5), ylim=(height - 0.5, -0.5), aspect="equal")
    bare(graph_axes, f"{len(result.cell_intensity):,} cells, {len(graph.edges):,} edges")
    foveated = np.clip(np.rint(result.cell_intensity), 0, 255).astype(np.uint8)[result.cell_of_pixel]
    show(foveated_axes, foveated, "mean intensity of each cell")
    return figure
