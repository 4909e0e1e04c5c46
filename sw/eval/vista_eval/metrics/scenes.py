"""Scores the cut and the reference method on single frames with exact labels."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from time import thread_time

from vista import parameters
from vista.chain import engine_parameters
from vista.engine import Engine, create_engine
from vista.errors import InputError
from vista.pipeline import Result

from vista_eval.baselines.reference_method import ReferenceParameters, merge_cells
from vista_eval.cell_graph import CellGraph, OpenPipeline
from vista_eval.dataset.scenes import LabelledScene
from vista_eval.metrics.segmentation import (
    Labels,
    PartitionScore,
    score_partition,
)

CUT = "cut"
REFERENCES = {  # the same graph, the same weights; k and min_cells of the best mean IoU on the dev half
    "reference method": ReferenceParameters(),
    "reference method, surfaces": ReferenceParameters(min_cells=10, respect_surfaces=True),
}


@dataclass(frozen=True)
class Partition:
    """What the host made of one scene."""

    result: Result
    graph: CellGraph
    refine: Callable[[Labels], Labels]  # region of each cell -> of each pixel
    host_ms: float  # processor time from words to regions and map


def partition_scenes(
    scenes: list[LabelledScene],
    values: parameters.Values,
    around_engine: Callable[[Engine], Engine] = lambda engine: engine,
) -> Iterator[tuple[LabelledScene, Partition]]:
    """Each scene through engine and host, by itself. around_engine: adds a step before or after matching."""
    if not scenes:
        return
    camera = scenes[0].camera
    engine = around_engine(create_engine("golden", engine_parameters(values)))
    pipeline = OpenPipeline(camera, values)
    for scene in scenes:
        if scene.camera != camera:
            raise InputError(scene.name, "has another camera than the scenes before")
        levels = list(engine.levels(scene.left, scene.right))
        pipeline.reset()
        start_s = thread_time()
        result = pipeline.process(scene.left, levels, scene.t_ns, scene.world_from_camera, scene.up_world)
        host_ms = 1e3 * (thread_time() - start_s)
        yield scene, Partition(result, pipeline.cell_graph(), pipeline.refine_boundaries, host_ms)


def reference_regions(partition: Partition, reference: ReferenceParameters) -> Labels:
    """Region of each pixel by the reference method, on the graph of the cut; drawn as those of the cut."""
    graph = partition.graph
    return partition.refine(merge_cells(graph.edges, graph.affinity, graph.horizontal, reference))


def cut_regions(partition: Partition) -> Labels:
    """Regions of the cut, to be compared with the reference's: before the host takes the ground at the foot
    of obstacles out."""
    return partition.refine(partition.result.region_of_cell)


def score_regions(scene: LabelledScene, partition: Partition, region_of_pixel: Labels) -> PartitionScore:
    return score_partition(
        scene.view, region_of_pixel, partition.result.cell_of_pixel, partition.graph.cell_size_px
    )


def score_cut(scene: LabelledScene, partition: Partition) -> PartitionScore:
    return score_regions(scene, partition, cut_regions(partition))


def score_scene(scene: LabelledScene, partition: Partition) -> dict[str, PartitionScore]:
    """Scores by partition: cut, reference methods."""
    regions = {CUT: cut_regions(partition)}
    regions |= {name: reference_regions(partition, reference) for name, reference in REFERENCES.items()}
    return {name: score_regions(scene, partition, region) for name, region in regions.items()}
