"""Which topics of a bag hold the left and the right images, the calibration and the poses.

What the user does not name is guessed where only one choice is possible; otherwise the error lists them.
"""

from __future__ import annotations

from vista.errors import InputError
from vista.sequence.bag_file import Bag
from vista.sequence.options import NO_POSES, Options

IMAGES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage")
CAMERA_INFO = "sensor_msgs/msg/CameraInfo"
ODOMETRY = "nav_msgs/msg/Odometry"
POSES = ("geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseWithCovarianceStamped")
TRANSFORM = "geometry_msgs/msg/TransformStamped"
TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
SIDES = (
    ("left", "right"),
    ("Left", "Right"),
    ("cam0", "cam1"),
    ("cam_0", "cam_1"),
    ("camera0", "camera1"),
    ("camera_0", "camera_1"),
    ("infra1", "infra2"),
)


def image_topics(bag: Bag, options: Options) -> tuple[str, str]:
    known = bag.topics(*IMAGES)
    named = options.left_topic, options.right_topic
    if None not in named:
        left, right = (_known(bag, topic, IMAGES, "image") for topic in named if topic is not None)
        if left == right:
            raise InputError("--right-topic", f"{right} is the left topic, too")
        return left, right
    pairs = [
        pair for pair in _pairs(known) if all(n in (None, of) for n, of in zip(named, pair, strict=True))
    ]
    if len(pairs) != 1:
        reason = (
            "several pairs of images" if pairs else "no topics of a left and a right image are recognised"
        )
        advice = "; choose --left-topic and --right-topic" if known else ""
        raise InputError(bag.path, f"{reason}{advice}; its image topics: {bag.listed(*IMAGES)}")
    return pairs[0]


def camera_info_topics(bag: Bag, images: tuple[str, str]) -> tuple[str, str] | None:
    """The topics beside the images, or else the only pair that there is, unless it is beside other images."""
    known = bag.topics(CAMERA_INFO)
    beside = [_info_beside(topic) for topic in images]
    if beside[0] != beside[1] and all(topic in known for topic in beside):
        return beside[0], beside[1]
    pairs = _pairs(known)
    of_others = {_info_beside(topic) for topic in bag.topics(*IMAGES)} - set(beside)
    return pairs[0] if len(pairs) == 1 and not of_others & set(pairs[0]) else None


def _info_beside(image: str) -> str:
    return f"{base_name(image).rpartition('/')[0]}/camera_info"


def pose_topic(bag: Bag, options: Options) -> str | None:
    """None: no topic is nothing but poses; transforms may still tell them."""
    types = (ODOMETRY, *POSES, TRANSFORM)
    known = bag.topics(*types)
    if options.pose_topic is not None:
        return _known(bag, options.pose_topic, (*types, *TRANSFORMS), "pose")
    if len(known) > 1:
        raise InputError(
            bag.path,
            f"several topics of poses: {', '.join(known)}; choose --pose-topic ({NO_POSES}: no poses)",
        )
    return known[0] if known else None


def base_name(topic: str) -> str:
    """The image topic that a compressed one belongs to."""
    return topic.removesuffix("/compressed")


def names_rectified(topic: str) -> bool:
    """Whether the images are rectified: by the names of ROS they are image_rect, image_rect_color then."""
    return "rect" in base_name(topic).rpartition("/")[2]


def _pairs(topics: list[str]) -> list[tuple[str, str]]:
    """Two topics that differ in the name of the side alone."""
    pairs = []
    for topic in topics:
        for left, right in SIDES:
            before, found, after = topic.rpartition(left)
            if found and (partner := before + right + after) in topics:
                pairs.append((topic, partner))
    return pairs


def _known(bag: Bag, topic: str, types: tuple[str, ...], what: str) -> str:
    if topic not in bag.topics(*types):
        listed = bag.listed(*types)
        raise InputError(bag.path, f"has no {what} topic {topic}; its {what} topics: {listed}")
    return topic
