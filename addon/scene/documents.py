"""Texts and images that were written; they are written over only if nobody changed them.

A mesh points to its own, and has the records of how they were left. Images that were made of
another image are known by records of the scene. Their pointers follow an image that is renamed, and
do not point to copies.
"""

from collections.abc import Callable, Sequence

import bpy
from bpy.props import PointerProperty, StringProperty
from spectral_tv.later import np
from spectral_tv.notes import note

from .contents import digest

Document = bpy.types.Text | bpy.types.Image


class SpectralTVDocument(bpy.types.PropertyGroup):
    """How a document was left.

    The group's own name is the mesh's property that points to it. An image has a pointer here.
    """

    digest: StringProperty(name="Digest", description="Of its contents")
    given: StringProperty(name="Given", description="The name that it was given")
    image: PointerProperty(type=bpy.types.Image, name="Image")
    source: PointerProperty(type=bpy.types.Image, name="Source")
    label: StringProperty(name="Label", description="What it is of its source")


# Those of a scene.
Records = bpy.types.bpy_prop_collection


def keep_text(mesh: bpy.types.Mesh, role: str, name: str, content: str) -> bpy.types.Text:
    """Keep a text as what ``role``, a property of the mesh, points to; returns it."""
    text = _own(mesh, role) or bpy.data.texts.new(name)
    text.from_string(content)
    _remember(mesh, role, text, name)
    return text


def keep_image(mesh: bpy.types.Mesh, role: str, name: str, pixels: "np.ndarray") -> bpy.types.Image:
    """Keep pixels (H, W, 4), from the bottom up, as :func:`keep_text` does a text."""
    height, width, _ = pixels.shape
    image = _own(mesh, role)
    if image is None:
        image = bpy.data.images.new(name, width, height, alpha=False)
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    image.pack()
    _remember(mesh, role, image, name)
    return image


def images_of(
    lists: Sequence[Records], source: bpy.types.Image, is_wanted: Callable[[str], bool]
) -> dict[str, bpy.types.Image]:
    """By label, the images that were written of a source and still name it, unless changed since.

    What was changed is noted, and forgotten.
    """
    found = {}
    for records in lists:
        for place in reversed(range(len(records))):
            each = records[place]
            if each.image is None:
                records.remove(place)
            elif each.source == source and is_wanted(each.label):
                is_named = each.image.spectral_tv.source == source
                if is_named and written_digest(each.image) == each.digest:
                    found[each.label] = each.image
                else:
                    note(f"{each.image.name!r} was changed since, and is kept")
                    records.remove(place)
    return found


def remember_image(
    lists: Sequence[Records], source: bpy.types.Image, label: str, image: bpy.types.Image
) -> None:
    """Remember how an image was left, in all lists that have it, or else in the first one."""
    image.spectral_tv.source, image.spectral_tv.label = source, label
    records = [each for records in lists for each in records if each.image == image]
    for each in records or [lists[0].add()]:
        each.image, each.source, each.label = image, source, label
        each.digest = written_digest(image)


def _own(mesh: bpy.types.Mesh, role: str) -> Document | None:
    """The document, unless the user changed it or it is that of the mesh this one was copied of."""
    document = getattr(mesh.spectral_tv, role)
    record = mesh.spectral_tv.documents.get(role)
    if document is None or record is None:
        return None
    if any(
        getattr(other.spectral_tv, role) == document for other in bpy.data.meshes if other != mesh
    ):
        return None
    if written_digest(document) != record.digest:
        kind = "text" if isinstance(document, bpy.types.Text) else "image"
        note(f"the {kind} {document.name!r} was changed since, and is kept")
        document.use_fake_user = True  # nothing else may use it
        return None
    return document


def _remember(mesh: bpy.types.Mesh, role: str, document: Document, name: str) -> None:
    documents = mesh.spectral_tv.documents
    record = documents.get(role)
    if record is None:
        record = documents.add()
        record.name = role
    # A name that the user gave stays.
    if getattr(mesh.spectral_tv, role) == document and document.name == record.given:
        document.name = name
    setattr(mesh.spectral_tv, role, document)
    record.digest, record.given = written_digest(document), document.name


def written_digest(document: Document) -> str:
    """Digest of what was written into a document; none of what was changed since or is linked."""
    if document.library is not None:
        return ""
    if isinstance(document, bpy.types.Text):
        return digest(np.frombuffer(document.as_string().encode(), dtype=np.uint8))
    if document.is_dirty or document.packed_file is None:
        return ""
    return digest(np.frombuffer(document.packed_file.data, dtype=np.uint8))
