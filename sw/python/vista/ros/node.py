"""The node: its subscriptions and publishers, and the live run between them."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import qos_profile_sensor_data
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.signals import SignalHandlerOptions

from vista.bag.types import Messages
from vista.chain import make_chain
from vista.errors import EXIT_OK, InputError
from vista.interruption import Interruption
from vista.live.loop import LiveLoop
from vista.ros.pairs import LEFT, RIGHT, LivePairs
from vista.ros.poses import LivePoses
from vista.ros.publisher import TYPES, Publisher
from vista.ros.settings import Settings, read_settings
from vista.ros.stereo import Names, StereoTopics

INFO, ODOMETRY = "sensor_msgs/msg/CameraInfo", "nav_msgs/msg/Odometry"
IMAGES = {  # by the name of the transport: what follows the name of the topic, and the type
    "raw": ("", "sensor_msgs/msg/Image"),
    "compressed": ("/compressed", "sensor_msgs/msg/CompressedImage"),
}
QUEUE = 10  # messages that a slow reader has not fetched
SPIN_S = 0.05
WATCH_S = 1.0


def run(ros_arguments: list[str]) -> int:
    """Runs the node until a signal ends it. ros_arguments: what follows --ros-args. Raises InputError."""
    interruption = Interruption()
    with interruption.watch(), _node(ros_arguments) as node:
        _serve(node, read_settings(node), lambda: interruption.requested)
    return EXIT_OK


@contextmanager
def _node(ros_arguments: list[str]) -> Iterator[Any]:
    try:
        rclpy.init(args=["--ros-args", *ros_arguments], signal_handler_options=SignalHandlerOptions.NO)
        node = rclpy.create_node("vista", automatically_declare_parameters_from_overrides=True)
    except Exception as error:  # of rcl, of rclpy or of the middleware
        raise InputError("--ros-args", str(error)[:300]) from None
    try:
        yield node
    finally:
        node.destroy_node()
        rclpy.shutdown()


# ---- topics ----


def message_class(type_name: str) -> Any:
    """Finds a class of messages for rclpy; type_name: such as sensor_msgs/msg/Image."""
    package, _, name = type_name.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), name)


def _subscribe(node: Any, store: Any, kind: str, topic: str, take: Callable[[Any], None]) -> None:
    node.create_subscription(
        message_class(kind),
        topic,
        lambda data: take(store.deserialize_cdr(data, kind)),
        qos_profile_sensor_data,  # REP 2003: it hears every publisher, reliable or not
        qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        raw=True,
    )


def _source(node: Any, settings: Settings, store: Any, spin: Callable[[], object]) -> StereoTopics:
    """Makes the source with its subscriptions."""
    images, infos = (
        [f"{side}/{name}" for side in ("left", "right")] for name in ("image_rect", "camera_info")
    )
    resolve = node.resolve_topic_name
    ending, kind = IMAGES[settings.transport]
    images = [resolve(name) + ending for name in images]  # that of the raw images is remapped
    names = Names((images[LEFT], images[RIGHT]), (resolve(infos[LEFT]), resolve(infos[RIGHT])))
    poses = None
    if settings.poses == "topic":
        poses = LivePoses(resolve("odometry"), settings.body_from_camera)
    pairs = LivePairs(settings.tolerance_ms)
    tell = node.get_logger().warning
    source = StereoTopics(names, spin, tell, pairs, poses, settings.poses == "odometry")
    for side in (LEFT, RIGHT):
        _subscribe(node, store, kind, images[side], partial(source.take_image, side))
        _subscribe(node, store, INFO, infos[side], partial(source.take_info, side))
    if poses is not None:
        _subscribe(node, store, ODOMETRY, "odometry", source.take_odometry)
    return source


def _publishers(node: Any) -> dict[str, Any]:
    """Reliable, so that every subscriber hears them (REP 2003)."""
    return {
        topic: node.create_publisher(
            message_class(kind),
            topic,
            QUEUE,
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )
        for topic, kind in TYPES.items()
    }


# ---- the run ----


class _Watch:
    """Tells once a second, in the diagnostics and on the screen, why no frame comes."""

    def __init__(self, node: Any, source: StereoTopics, publisher: Publisher) -> None:
        self._node, self._source, self._publisher = node, source, publisher
        self._before: str | None = None
        node.create_timer(WATCH_S, self._look)

    def _look(self) -> None:
        problem = self._source.problem()
        if problem is None and self._publisher.silent():
            problem = "no frame is processed: the images repeat those before, or the machine is too slow"
        if problem is not None:
            self._publisher.tell_blind(self._node.get_clock().now().nanoseconds, problem)
        if problem != self._before:
            tell = self._node.get_logger()
            tell.info("frames come again") if problem is None else tell.warning(problem)
        self._before = problem


def _serve(node: Any, settings: Settings, interrupted: Callable[[], bool]) -> None:
    messages = Messages()
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    source = _source(node, settings, messages.store, lambda: executor.spin_once(timeout_sec=SPIN_S))
    publisher = Publisher(_publishers(node), messages)
    _Watch(node, source, publisher)
    while (recorded := source.sequence(interrupted)) is not None:
        try:
            chain = make_chain(recorded, settings.engine, settings.values, settings.threads, every_pair=False)
        except InputError as error:
            source.refuse(error)
            continue
        camera = chain.rectifier.calibration
        publisher.describe(camera, chain.engine.parameters.num_disparities, source.frame_id)
        node.get_logger().info(f"obstacles are looked for in images of {camera.width}x{camera.height} px")
        LiveLoop(chain, source).run([publisher], interrupted)
