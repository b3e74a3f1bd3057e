"""The node groups that displace a mesh by vector attributes.

A modifier has the group of its decomposition. That one names the attributes, and has inputs of the
same names: a gain, a mask and a mute for each band. What the bands add up to is in an inner group,
which all groups of as many bands share.
"""

from collections.abc import Collection, Sequence

import bpy
from bpy.props import BoolProperty, CollectionProperty, IntProperty, StringProperty

# Of the inner group. Another one is made where that of a file is of another version.
VERSION = 1
# Gains between which sliders go, unless they are widened.
USUAL_RANGE = (-1.0, 2.0)


class SpectralTVNodeBand(bpy.types.PropertyGroup):
    """A band of a group: its attribute, and the identifiers of its inputs."""

    name: StringProperty(name="Name", description="Of the attribute")
    gain: StringProperty(name="Gain")
    mask: StringProperty(name="Mask")
    mute: StringProperty(name="Mute")
    lock_shape: BoolProperty(name="Lock", description="Of the shape key that it was, or will be")


class SpectralTVNodes(bpy.types.PropertyGroup):
    """What a node group is to the extension."""

    owner = bpy.types.NodeTree, "spectral_tv"

    mark: StringProperty(name="Mark", description="That of the records whose bands it has")
    version: IntProperty(name="Version", description="Of an inner group; 0 if it is none")
    count: IntProperty(name="Bands", description="How many an inner group adds up")
    bands: CollectionProperty(type=SpectralTVNodeBand)


def make(name: str, bands: Sequence[str]) -> bpy.types.NodeTree:
    """A new group for the attributes ``bands``."""
    group = bpy.data.node_groups.new(name, "GeometryNodeTree")
    group.is_modifier = True
    for way in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    for each in bands:
        _add_band(group, each)
    _connect(group)
    return group


def rename(group: bpy.types.NodeTree, band: SpectralTVNodeBand, name: str) -> None:
    """Have a band be of the attribute of another name."""
    band.name = name
    for socket, label in _labels(band).items():
        socket_of(group, socket).name = label
    _connect(group)


def remove(group: bpy.types.NodeTree, gains: Collection[str]) -> None:
    """Remove bands, by the identifiers of their gains."""
    kept = group.spectral_tv.bands
    for place in reversed(range(len(kept))):
        if kept[place].gain in gains:
            for socket in _labels(kept[place]):
                group.interface.remove(socket_of(group, socket))
            kept.remove(place)
    _connect(group)


def socket_of(group: bpy.types.NodeTree, identifier: str) -> bpy.types.NodeTreeInterfaceSocket:
    """An input of a group."""
    return next(
        each
        for each in group.interface.items_tree
        if getattr(each, "identifier", "") == identifier and each.in_out == "INPUT"
    )


def set_ends(group: bpy.types.NodeTree, gain: str, least: float, most: float) -> None:
    """Have a gain go from the least to the most, and act as one of the two beyond."""
    socket, node = socket_of(group, gain), group.nodes[_ends(gain)]
    socket.min_value, socket.max_value = least, most
    node.inputs["Min"].default_value, node.inputs["Max"].default_value = least, most


def discard(group: bpy.types.NodeTree) -> None:
    """Remove a group, and its inner one, unless something uses them."""
    inner = [node.node_tree for node in group.nodes if node.type == "GROUP"]
    for each in (group, *inner):
        if each is not None and each.users == 0:
            bpy.data.node_groups.remove(each)


def _ends(gain: str) -> str:
    """What the node is called that keeps a gain between its ends."""
    return f"Ends of {gain}"


def _labels(band: SpectralTVNodeBand) -> dict[str, str]:
    """What the inputs of a band are called, by their identifiers."""
    return {
        band.gain: band.name,
        band.mask: f"{band.name} Mask",
        band.mute: f"{band.name} Mute",
    }


def _add_band(group: bpy.types.NodeTree, name: str) -> None:
    band = group.spectral_tv.bands.add()
    band.name = name
    gain, mask, mute = (
        group.interface.new_socket(label, in_out="INPUT", socket_type=f"NodeSocket{kind}")
        for label, kind in ((name, "Float"), (f"{name} Mask", "Float"), (f"{name} Mute", "Bool"))
    )
    gain.min_value, gain.max_value = USUAL_RANGE
    gain.description = (
        "−1 removes the band, 0 leaves it, 1 doubles it. Beyond the ends of the slider it acts as "
        "these do, like a shape key"
    )
    mask.default_value, mask.min_value, mask.max_value, mask.subtype = 1.0, 0.0, 1.0, "FACTOR"
    mask.description = "How much of the band acts: a vertex group, another attribute, or a number"
    for each in (gain, mute):
        _have_one_value(each)
    band.gain, band.mask, band.mute = (each.identifier for each in (gain, mask, mute))


def _have_one_value(socket: bpy.types.NodeTreeInterfaceSocket) -> None:
    """Have an input be the same everywhere, not of an attribute."""
    if hasattr(socket, "structure_type"):  # since Blender 5.0
        socket.structure_type = "SINGLE"
    else:
        socket.force_non_field = True


def _connect(group: bpy.types.NodeTree) -> None:
    """Make the nodes anew."""
    former = [node.node_tree for node in group.nodes if node.type == "GROUP"]
    group.nodes.clear()
    bands = group.spectral_tv.bands
    nodes, links = group.nodes, group.links
    start, end = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    inner = nodes.new("GeometryNodeGroup")
    inner.node_tree = _inner(len(bands))
    start.location, inner.location, end.location = (-300, 0), (200, 0), (450, 0)
    inner.width = 200
    given = {socket.identifier: socket for socket in start.outputs}
    links.new(start.outputs["Geometry"], inner.inputs["Geometry"])
    links.new(inner.outputs["Geometry"], end.inputs["Geometry"])
    for place, band in enumerate(bands):
        attribute = nodes.new("GeometryNodeInputNamedAttribute")
        attribute.data_type, attribute.label = "FLOAT_VECTOR", band.name
        attribute.inputs["Name"].default_value = band.name
        attribute.location = -50, -150 * (place + 1)
        ends, socket = nodes.new("ShaderNodeClamp"), socket_of(group, band.gain)
        ends.name, ends.location, ends.hide = _ends(band.gain), (-50, -150 * place - 100), True
        ends.inputs["Min"].default_value = socket.min_value
        ends.inputs["Max"].default_value = socket.max_value
        links.new(given[band.gain], ends.inputs["Value"])
        sources = (attribute.outputs["Attribute"], ends.outputs[0], given[band.mask])
        for target, source in enumerate((*sources, given[band.mute]), start=1 + 4 * place):
            links.new(source, inner.inputs[target])
    for each in former:
        if each is not None and each.users == 0:
            bpy.data.node_groups.remove(each)


def _inner(count: int) -> bpy.types.NodeTree:
    """The group that adds so many bands up: the one there is, or a new one."""
    for each in bpy.data.node_groups:
        known = each.spectral_tv
        if each.library is None and (known.version, known.count) == (VERSION, count):
            return each
    group = bpy.data.node_groups.new(
        f"Spectral TV {count} {'Band' if count == 1 else 'Bands'}", "GeometryNodeTree"
    )
    group.spectral_tv.version, group.spectral_tv.count = VERSION, count
    for way in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    for band in range(1, count + 1):
        for label, kind in (("Band", "Vector"), ("Gain", "Float"), ("Mask", "Float")):
            group.interface.new_socket(
                f"{label} {band}", in_out="INPUT", socket_type=f"NodeSocket{kind}"
            )
        group.interface.new_socket(f"Mute {band}", in_out="INPUT", socket_type="NodeSocketBool")
    nodes, links = group.nodes, group.links
    start, end = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    moved = nodes.new("GeometryNodeSetPosition")
    start.location = -300, 0
    total = None
    for place in range(count):
        total = _add_up(group, start.outputs[1 + 4 * place : 5 + 4 * place], total, place)
    moved.location, end.location = (900, 0), (1100, 0)
    links.new(start.outputs["Geometry"], moved.inputs["Geometry"])
    if total is not None:
        links.new(total, moved.inputs["Offset"])
    links.new(moved.outputs["Geometry"], end.inputs["Geometry"])
    return group


def _add_up(
    group: bpy.types.NodeTree,
    inputs: Sequence[bpy.types.NodeSocket],
    total: bpy.types.NodeSocket | None,
    place: int,
) -> bpy.types.NodeSocket:
    """Add a band to what those before it add up to; of one at rest nothing is computed."""
    nodes, links = group.nodes, group.links
    vector, gain, mask, mute = inputs
    made = [
        nodes.new(kind)
        for kind in (
            "FunctionNodeCompare", "FunctionNodeBooleanMath", "ShaderNodeMath",
            "ShaderNodeVectorMath", "ShaderNodeVectorMath", "GeometryNodeSwitch",
        )
    ]  # fmt: skip
    is_zero, is_off, share, scaled, added, chosen = made
    for column, node in enumerate(made):
        node.location = 150 * column, -250 * place
        node.hide = True
    is_zero.data_type, is_zero.operation = "FLOAT", "EQUAL"
    is_zero.inputs["Epsilon"].default_value = 0.0
    is_off.operation, share.operation = "OR", "MULTIPLY"
    scaled.operation, added.operation = "SCALE", "ADD"
    chosen.input_type = "VECTOR"
    for source, target in (
        (gain, is_zero.inputs[0]),
        (is_zero.outputs[0], is_off.inputs[0]),
        (mute, is_off.inputs[1]),
        (gain, share.inputs[0]),
        (mask, share.inputs[1]),
        (vector, scaled.inputs[0]),
        (share.outputs[0], scaled.inputs["Scale"]),
        (scaled.outputs[0], added.inputs[1]),
        (is_off.outputs[0], chosen.inputs["Switch"]),
        (added.outputs[0], chosen.inputs["False"]),
    ):
        links.new(source, target)
    if total is not None:
        links.new(total, added.inputs[0])
        links.new(total, chosen.inputs["True"])
    return chosen.outputs[0]
