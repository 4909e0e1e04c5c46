"""libvista's stages over numpy arrays, for their tests: the library, its memory, the view of a frame that
every stage takes, the first half of the chain, and frames to put through it. What a stage takes is put
together here alone."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from weakref import WeakKeyDictionary

import numpy as np
from vista import native
from vista.engine import INVALID
from vista_stages_abi import ffi

lib = ffi.dlopen(str(native.build_folder() / "lib" / "libvista_stages.so"))


def pointer(array: np.ndarray):
    """The array as an int32_t pointer; empty arrays are valid too."""
    assert array.dtype == np.int32 and array.flags.c_contiguous
    return ffi.cast("int32_t *", array.ctypes.data)


def status_name(status: int) -> str:
    return ffi.string(lib.vista_status_name(status)).decode()


def default_parameters():
    """A new vista_parameters; what it points to lives as long as it does."""
    values = ffi.new("vista_parameters *")
    assert lib.vista_parameters_init(values, ffi.sizeof("vista_parameters")) == lib.VISTA_OK
    return values


class Arena:
    """Memory for an arena: first counted with `layout`, then laid out on exactly that many bytes."""

    def __init__(self, layout, missing_bytes: int = 0) -> None:
        self.arena = ffi.new("vista_arena *")
        layout(self.arena)
        self.size = self.arena.used - missing_bytes
        self._memory = np.empty(self.size + 64, np.uint8)
        start = -self._memory.ctypes.data % 64
        self.arena.base = ffi.cast("unsigned char *", self._memory.ctypes.data + start)
        self.arena.size, self.arena.used = self.size, 0
        self.status = layout(self.arena)


LEVEL_UP = (0.0, -1.0, 0.0)
RUN = np.dtype([("u", np.int32), ("v", np.int32), ("length", np.int32)])

# What the tests rely on, so that tuning the defaults leaves them alone.
PARAMETERS: dict[str, float] = {
    "foveation.sector_count": 96,
    "foveation.rho_0_px": 4.0,
    "affinity.form": lib.VISTA_AFFINITY_FORM_PRODUCT,
    "affinity.sigma_intensity": 10.0,
    "affinity.mu_disparity_px": 0.5,
    "affinity.mu_depth_m": 0.5,
    "affinity.sigma_disparity_px": 1.0,
    "affinity.flow_encoding": lib.VISTA_AFFINITY_FLOW_ENCODING_EXPONENTIAL,
    "segmentation.seed_step_px": 0.5,
    "segmentation.seed_area_px2": 60.0,
    "segmentation.reach": 12,
    "segmentation.horizontal_link": 2.0,
    "segmentation.merge_ratio": 2.0,
    "region.min_disparity_px": 2.5,
    "region.min_size_m": 0.35,
    "region.min_inlier_fraction": 0.5,
    "region.min_height_m": 0.3,
}


def parameters(changes: dict[str, float] | None = None):
    values = default_parameters()
    for name, value in (PARAMETERS | (changes or {})).items():
        assert lib.vista_parameters_set(values, name.encode(), value) == lib.VISTA_OK, name
    culprit = ffi.new("const char **")
    assert lib.vista_parameters_check(values, culprit) == lib.VISTA_OK, ffi.string(culprit[0])
    return values


def camera(width: int = 320, height: int = 240, focal: float = 400.0, baseline: float = 0.5):
    """The principal point in the middle of the image."""
    return ffi.new("vista_camera *", [width, height, focal, (width - 1) / 2, (height - 1) / 2, baseline])


def view(pointer, count: int, dtype) -> np.ndarray:
    """The library's own array, not a copy."""
    return np.frombuffer(ffi.buffer(pointer, count * np.dtype(dtype).itemsize), dtype)


_kept: WeakKeyDictionary = WeakKeyDictionary()  # what the view of a frame points into


def image_struct(kind: str, array: np.ndarray):
    """An array with its stride as vista_image or vista_disparity_image."""
    dtype, item = {"image": (np.uint8, "uint8_t *"), "disparity_image": (np.int16, "int16_t *")}[kind]
    assert array.dtype == dtype and array.strides[1] == array.itemsize
    height, width = array.shape
    struct = ffi.new(
        f"vista_{kind} *",
        [ffi.cast(item, array.ctypes.data), width, height, array.strides[0] // array.itemsize],
    )
    _kept[struct] = array
    return struct


POINTERS = ("params", "camera", "foveation")


def frame_view(parameters, camera, **given):
    """A vista_frame_view *: a level camera at the origin that stands still, all of whose image is matched,
    unless told otherwise as set_frame takes it."""
    frame = ffi.new("vista_frame_view *", {"up_camera": LEVEL_UP, "seen": True})
    _kept[frame] = {}
    frame.matched.disparity_max_px = 127.0
    for k in (0, 4, 8):
        frame.motion.pose.rotation[k] = 1.0
    for name, value in ({"params": parameters, "camera": camera} | given).items():
        set_frame(frame, name, value)
    return frame


def set_frame(frame, name: str, value) -> None:
    """One member of a view: a struct or a pointer to it, a number, the image or the words as an array, the
    levels as a list of them, the noise as its standard deviation, up_camera as three numbers."""
    if name in ("image", "words") and isinstance(value, np.ndarray):
        value = image_struct("image" if name == "image" else "disparity_image", value)
    if name == "levels":
        value = [image_struct("disparity_image", words) for words in value]
        for k, words in enumerate(value):
            frame.levels[k] = words[0]
        frame.matched.coarser_levels = len(value) - 1
    elif name == "noise":
        frame.noise.sigma = value
    elif name == "up_camera":
        frame.up_camera = [float(x) for x in value]
    elif name in POINTERS or not isinstance(value, ffi.CData):
        setattr(frame, name, value)
    else:
        setattr(frame, name, value[0] if ffi.typeof(value).kind == "pointer" else value)
    _kept[frame][name] = value


class Foveation:
    def __init__(self, width: int, height: int, center=None, changes=None, missing_bytes: int = 0) -> None:
        self._parameters = parameters(changes)
        self.params = ffi.addressof(self._parameters, "foveation")
        self.center = center or ((width - 1) / 2, (height - 1) / 2)
        self.handle = f = ffi.new("vista_foveation *")
        fovea = ffi.new("vista_fovea *", [width, height, *self.center])
        self.arena = Arena(
            lambda arena: lib.vista_foveation_layout(f, arena, self.params, fovea),
            missing_bytes,
        )
        self.status = status_name(self.arena.status)
        if self.arena.status != lib.VISTA_OK:
            return
        self.node_count, self.arc_count = f.node_count, f.graph.arc_count
        self.cell_of_pixel = view(f.cell_of_pixel, width * height, np.int32).reshape(height, width)
        self.node_of_grid = view(f.node_of_grid, f.ring_count * f.sector_count, np.int32).reshape(
            f.ring_count, f.sector_count
        )
        self.first_run = view(f.first_run, self.node_count + 1, np.int32)
        self.runs = view(f.runs, int(self.first_run[-1]), RUN)
        self.pixel_count = view(f.pixel_count, self.node_count, np.int32)
        self.pixel_u = view(f.pixel_u, width * height, np.int16)
        self.pixel_v = view(f.pixel_v, width * height, np.int16)
        self.center_u = view(f.center_u, self.node_count, np.float32)
        self.center_v = view(f.center_v, self.node_count, np.float32)
        self.size_px = view(f.size_px, self.node_count, np.float32)
        self.arc_distance_px = view(f.arc_distance_px, self.arc_count, np.float32)
        first_arc = view(f.graph.first_arc, self.node_count + 1, np.int32)
        self.tail = np.repeat(np.arange(self.node_count, dtype=np.int32), np.diff(first_arc))
        self.head = view(f.graph.head, self.arc_count, np.int32)
        self.reverse = view(f.graph.reverse, self.arc_count, np.int32)


class Stages:
    """Foveation to regions for one camera, each stage with its memory. Tests may write to the arrays."""

    def __init__(self, camera, changes: dict[str, float] | None = None) -> None:
        self.camera, self.parameters = camera, parameters(changes)
        self.foveation = f = Foveation(camera.width_px, camera.height_px, changes=changes)
        self.frame = frame_view(self.parameters, camera, foveation=f.handle)
        self._arenas: list[Arena] = []
        self.cells = self._lay_out("vista_cells", lib.vista_cells_layout)
        self.surfaces = self._lay_out("vista_surfaces", lib.vista_surfaces_layout)
        self.affinity = self._lay_out("vista_affinity", lib.vista_affinity_layout)
        self.segmentation = self._lay_out("vista_segmentation", lib.vista_segmentation_layout)
        self.seeds = self._lay_out("vista_seeds", lib.vista_seeds_layout)
        self.refinement = self._lay_out("vista_refinement", lib.vista_refinement_layout)
        self.regions = self._lay_out("vista_regions", lib.vista_regions_layout)
        self.intensity = view(self.cells.intensity, f.node_count, np.float32)
        self.disparity_px = view(self.cells.disparity_px, f.node_count, np.float32)
        self.words = view(self.cells.words, f.cell_of_pixel.size, np.int16)
        self.greys = view(self.cells.greys, f.cell_of_pixel.size, np.uint8)
        self.listed = view(self.refinement.listed, f.cell_of_pixel.size, np.int32)
        self.border = view(self.refinement.border, f.node_count, np.uint8)
        self.valid_fraction = view(self.cells.valid_fraction, f.node_count, np.float32)
        self.inclination_deg = view(self.surfaces.inclination_deg, f.node_count, np.float32)
        self.horizontal = view(self.surfaces.horizontal, f.node_count, np.uint8)
        self.weight = view(self.affinity.weight, f.arc_count, np.float32)
        self.capacity = view(self.affinity.capacity, f.arc_count, np.int32)
        self.intensity_capacity = view(self.affinity.intensity_capacity, f.arc_count, np.int32)
        self.label = view(self.segmentation.label, f.node_count, np.int32)
        self.region_of_pixel = view(self.refinement.label, f.cell_of_pixel.size, np.int32).reshape(
            f.cell_of_pixel.shape
        )
        self.seed_of_node = view(self.seeds.seed_of_node, f.node_count, np.int32)
        self.shell = view(self.seeds.shell, f.node_count, np.uint8)

    def _lay_out(self, name: str, layout):
        handle = ffi.new(f"{name} *")
        arena = Arena(lambda arena: layout(handle, arena, self.foveation.handle))
        assert arena.status == lib.VISTA_OK, status_name(arena.status)
        self._arenas.append(arena)
        return handle

    def section(self, name: str):
        return ffi.addressof(self.parameters, name)

    def see(self, up=None, **given) -> None:
        """What the frame is, as frame_view takes it."""
        if up is not None:
            given["up_camera"] = up
        for name, value in given.items():
            set_frame(self.frame, name, value)

    def foveate(self, image: np.ndarray, words: np.ndarray) -> None:
        self.see(image=image, words=words)
        lib.vista_foveate(self.frame, self.cells)

    def find_surfaces(self, up=LEVEL_UP) -> None:
        self.see(up)
        lib.vista_surfaces_compute(self.frame, self.cells, self.surfaces)

    def compare(self) -> None:
        lib.vista_affinity_compute(self.frame, self.cells, self.affinity)

    def find_obstacle_seeds(self) -> list[np.ndarray]:
        lib.vista_seeds_of_obstacles(self.frame, self.cells, self.surfaces, self.seeds)
        return self._seed_members()

    def find_rest_seeds(self, label: np.ndarray) -> list[np.ndarray]:
        label = np.ascontiguousarray(label, np.int32)
        lib.vista_seeds_of_rest(self.frame, self.affinity, self.surfaces, pointer(label), self.seeds)
        return self._seed_members()

    def _seed_members(self) -> list[np.ndarray]:
        first = view(self.seeds.first_member, self.seeds.count + 1, np.int32)
        members = view(self.seeds.members, self.foveation.node_count, np.int32)
        return [members[a:b].copy() for a, b in pairwise(first)]

    def segment(self) -> None:
        status = lib.vista_segment(self.frame, self.cells, self.surfaces, self.affinity, self.segmentation)
        assert status == lib.VISTA_OK, status_name(status)

    def refine(self, image: np.ndarray) -> None:
        self.greys[:] = image[self.foveation.pixel_v, self.foveation.pixel_u]
        lib.vista_refine(self.frame, self.cells, self.segmentation.label, self.refinement)

    def measure_regions(self, words: np.ndarray, up=LEVEL_UP) -> list:
        """Measures the regions as the cells draw them."""
        self.region_of_pixel[:] = self.label[self.foveation.cell_of_pixel]
        return self.compute_regions(words, up)

    def compute_regions(self, words: np.ndarray, up=LEVEL_UP) -> list:
        """Measures and judges the regions as region_of_pixel draws them."""
        self.see(up, words=words)
        self.words[:] = words[self.foveation.pixel_v, self.foveation.pixel_u]
        self.listed[:] = self.region_of_pixel[self.foveation.pixel_v, self.foveation.pixel_u]
        self.border[:] = 1  # any pixel may be drawn as another region's than its cell's
        s = self.segmentation
        partition = ffi.new("vista_partition *", [s.label, s.region_count, s.obstacle_count, self.refinement])
        lib.vista_regions_compute(self.frame, self.cells, self.surfaces, partition, self.regions)
        return [ffi.new("vista_region *", self.regions.items[k]) for k in range(self.regions.count)]

    def partition(self, image: np.ndarray, words: np.ndarray, up=LEVEL_UP) -> np.ndarray:
        """Everything up to the cuts; the label of every pixel."""
        self.foveate(image, words)
        self.find_surfaces(up)
        self.compare()
        self.segment()
        return self.label[self.foveation.cell_of_pixel]

    def run(self, image: np.ndarray, words: np.ndarray, up=LEVEL_UP) -> list:
        self.partition(image, words, up)
        return self.measure_regions(words, up)


def rays(camera) -> np.ndarray:
    """(height, width, 3): the point at depth 1 behind every pixel."""
    v, u = np.mgrid[: camera.height_px, : camera.width_px]
    x, y = (u - camera.center_u_px) / camera.focal_px, (v - camera.center_v_px) / camera.focal_px
    return np.stack([x, y, np.ones_like(x)], axis=-1)


def plane_disparity(camera, normal, point) -> np.ndarray:
    """Disparity of the plane through `point` with this normal, from its depth on every ray; <= 0: unseen."""
    normal, point = np.asarray(normal, float), np.asarray(point, float)
    with np.errstate(divide="ignore"):
        depth_m = normal @ point / (rays(camera) @ normal)
    return camera.focal_px * camera.baseline_m / depth_m


def words_of(disparity_px: np.ndarray, random: np.random.Generator | None = None, sigma_px=0.0) -> np.ndarray:
    noise = random.normal(0.0, sigma_px, disparity_px.shape) if random is not None else 0.0
    words = np.rint(16 * (disparity_px + noise))
    return np.where(disparity_px > 0, words, INVALID).astype(np.int16)


GROUND, BACKGROUND, SKY, FIRST_THING = 0, 1, 2, 3


@dataclass
class Board:
    """An upright rectangle facing a level camera, metres; only a rim of it has texture."""

    x_m: float
    y_m: float
    z_m: float
    width_m: float
    height_m: float
    grey: int = 60
    rim_px: float | None = None  # None: textured all over


def street(
    camera, boards: list[Board], random: np.random.Generator, ground_m: float = 3.0, far_m: float = 80.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Grey image, words and owner (GROUND .. FIRST_THING + k) of level ground, far houses to a little above
    the horizon, empty sky, and the boards."""
    ray = rays(camera)
    scale = camera.focal_px * camera.baseline_m
    ground = plane_disparity(camera, (0, 1, 0), (0, ground_m, 0))
    disparity = np.maximum(ground, scale / far_m)
    owner = np.where(ground > scale / far_m, GROUND, BACKGROUND)
    sky = ray[..., 1] * far_m < -6.0
    owner[sky], disparity[sky] = SKY, -1.0
    grey = np.choose(owner, [110, 160, 230]).astype(float)
    for k, board in sorted(enumerate(boards), key=lambda item: -item[1].z_m):
        x, y = ray[..., 0] * board.z_m - board.x_m, ray[..., 1] * board.z_m - board.y_m
        from_edge_m = np.minimum(board.width_m / 2 - np.abs(x), board.height_m / 2 - np.abs(y))
        on = from_edge_m >= 0
        owner[on], grey[on], disparity[on] = FIRST_THING + k, board.grey, scale / board.z_m
        if board.rim_px is not None:
            disparity[from_edge_m * camera.focal_px / board.z_m >= board.rim_px] = -1.0
    image = np.clip(grey + random.normal(0, 2, grey.shape), 0, 255).astype(np.uint8)
    return image, words_of(disparity, random, 0.1), owner
