"""Colours, textures, light and faces, pixel by pixel."""

from dataclasses import replace

import numpy as np
import pytest

from osgode.graph.appearance import Appearance, Texture
from osgode.graph.frame import Frame, Sky, Sun, View
from osgode.graph.mesh import Mesh
from osgode.graph.primitives import box_mesh, sphere_mesh
from osgode.maths import Pose, Quat, Vec3
from tests.render.scenes import BLUE, CLEAR, GREEN, RED, SIZE, blocks, many, place, quad, unlit

FRONT = place((0, 0, -5))
ABOUT = Quat.from_axis_angle((0, 1, 0), np.pi)
HEADLIGHT = Sun(direction=Vec3(0, 0, -1), shadows=False)


def shot(drawer, *opaque, **more):
    """The picture of some bins, the camera at the origin."""
    drawer.draw(Frame(**{"view": View(), "size": SIZE, "opaque": list(opaque), "sky": CLEAR} | more))
    return drawer.image().astype(int)


def middle(image):
    """The colour in the middle of a picture."""
    return image[50, 80]


def test_image_is_bytes_with_the_first_row_at_the_top(drawer):
    """What is high in the world is in the first rows, what is on the right in the last columns."""
    drawer.draw(Frame(View(), SIZE, [many(quad(), unlit(RED), place((2, 1.5, -5)))], sky=CLEAR))
    image = drawer.image()
    assert image.shape == (100, 160, 3)
    assert image.dtype == np.uint8
    red = (image == (255, 0, 0)).all(axis=2)
    rows, columns = np.nonzero(red)
    assert rows.max() < 50
    assert columns.min() > 80


@pytest.mark.parametrize("level", [0.0, 0.02, 0.1, 0.5, 0.9, 1.0])
def test_unlit_colour_is_kept(drawer, level):
    """An unlit colour comes out as it went in: decoding and encoding of sRGB cancel."""
    image = shot(drawer, many(quad(), unlit((level, 1 - level, 0.3, 1)), FRONT))
    assert np.abs(middle(image) - np.round(np.array([level, 1 - level, 0.3]) * 255)).max() <= 1


@pytest.mark.parametrize("level", [0, 10, 128, 255])
def test_unlit_texture_is_kept(drawer, level):
    """A texture's bytes come out as they went in."""
    texture = Texture(np.full((4, 4, 3), level, np.uint8))
    assert np.abs(middle(shot(drawer, many(quad(), unlit((1, 1, 1), texture), FRONT))) - level).max() <= 1


def test_texture_is_upright(drawer):
    """The first row of the image is at v = 1, its first column at u = 0."""
    texture = blocks([(255, 0, 0), (0, 255, 0)], [(0, 0, 255), (255, 255, 255)])
    image = shot(drawer, many(quad(), unlit((1, 1, 1), texture), FRONT))
    corners = [image[36, 66], image[36, 94], image[64, 66], image[64, 94]]
    assert np.allclose(corners, [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]], atol=2)


def test_texture_is_averaged_as_light(drawer):
    """A fine black and white pattern seen from afar is half the light, not half the number."""
    board = np.indices((64, 64)).sum(axis=0) % 2 * 255
    texture = Texture(np.repeat(board[:, :, None], 3, axis=2).astype(np.uint8))
    far = shot(drawer, many(quad(), unlit((1, 1, 1), texture), place((0, 0, -30))))
    assert np.abs(middle(far) - 188).max() <= 3


def test_texture_repeats_only_if_asked(drawer):
    """Past its edge a texture starts again, or goes on as it ended."""
    image = np.array([[[255, 0, 0], [0, 0, 255]]], np.uint8)
    base = quad()
    twice = Mesh(base.vertices, base.triangles, base.normals, base.uvs * 2)
    seen = [
        shot(drawer, many(twice, unlit((1, 1, 1), Texture(image, repeat=repeat)), FRONT))[50, 85]
        for repeat in (True, False)
    ]
    assert seen[0][0] > seen[0][2]
    assert seen[1][0] < seen[1][2]


def test_holes_of_a_texture_are_cut_out(drawer):
    """An opaque thing is not there where its texture is transparent, and hides nothing there."""
    texture = blocks([(255, 255, 255, 255), (255, 255, 255, 0)])
    front = many(quad(), unlit(GREEN, texture), place((0, 0, -4)))
    behind = many(quad(), unlit(RED), FRONT)
    image = shot(drawer, front, behind)
    assert image[50, 65].tolist() == [0, 255, 0]
    assert image[50, 95].tolist() == [255, 0, 0]


def test_instances_are_drawn_where_their_matrices_say(drawer):
    """One bin, three places: three patches and nothing between."""
    image = shot(drawer, many(quad(), unlit(RED), *(place((x, 0, -8)) for x in (-4, 0, 4))))
    red = (image[50] == (255, 0, 0)).all(axis=1)
    assert np.count_nonzero(np.diff(red.astype(int)) == 1) == 3


def test_every_bin_uses_its_own_matrices(drawer):
    """Bins that share a mesh are not mixed up, whatever their sizes."""
    mesh = quad()
    image = shot(
        drawer,
        many(mesh, unlit(RED), place((-2.5, 0, -5)), place((-2.5, 2, -5))),
        many(mesh, unlit(GREEN), FRONT),
        many(mesh, unlit(BLUE), place((2.5, 0, -5))),
    )
    assert [image[50, x].tolist() for x in (40, 80, 120)] == [[255, 0, 0], [0, 255, 0], [0, 0, 255]]


def test_nearer_hides_farther(drawer):
    """Depth decides among opaque things, not their order."""
    near, far = many(quad(), unlit(RED), place((0, 0, -4))), many(quad(), unlit(BLUE), FRONT)
    assert middle(shot(drawer, near, far)).tolist() == middle(shot(drawer, far, near)).tolist() == [255, 0, 0]


def test_both_sides_of_a_sheet_are_seen_and_lit(drawer):
    """A sheet turned round looks the same: it has two faces, each lit from its own side."""
    white = Appearance((0.8, 0.8, 0.8))
    front = shot(drawer, many(quad(), white, FRONT), sun=HEADLIGHT)
    back = shot(drawer, many(quad(), white, place((0, 0, -5), ABOUT)), sun=HEADLIGHT)
    assert np.abs(front - back).max() <= 1
    assert middle(front).min() > 150


def test_a_room_is_seen_from_inside(drawer):
    """A solid shows its inner faces to an eye within it."""
    image = shot(drawer, many(box_mesh(), unlit(RED), place(scale=(10, 10, 10))))
    assert (image == (255, 0, 0)).all()


def test_a_solid_cut_open_by_the_near_plane_is_not_empty(drawer):
    """An eye just outside a wall doesn't look through it."""
    image = shot(drawer, many(box_mesh(), unlit(RED), place((0, 0, -5.05), scale=(10, 10, 10))))
    assert (image == (255, 0, 0)).all()


def test_mirrored_solid_is_lit_like_the_plain_one(drawer):
    """A negative scale shows the outside, lit from outside."""
    white = Appearance((0.8, 0.8, 0.8))
    turned = Quat.from_axis_angle((1, 1, 0), 0.6)
    plain = shot(drawer, many(box_mesh(), white, place((0, 0, -4), turned)))
    mirrored = shot(drawer, many(box_mesh(), white, place((0, 0, -4), turned, (-1, 1, 1))))
    assert np.abs(plain - mirrored).max() <= 1


def test_normals_of_stretched_things(drawer):
    """A sphere stretched by its matrix is lit like a mesh of that shape."""
    white = Appearance((0.8, 0.8, 0.8))
    ball, stretch = sphere_mesh(), np.array([1.5, 0.4, 0.8])
    normals = ball.normals / stretch
    baked = Mesh(ball.vertices * stretch, ball.triangles, normals / np.linalg.norm(normals, axis=1, keepdims=True))
    by_matrix = shot(drawer, many(ball, white, place((0, 0, -4), scale=stretch)))
    by_mesh = shot(drawer, many(baked, white, place((0, 0, -4))))
    assert np.abs(by_matrix - by_mesh).mean() < 0.05


def test_light_comes_from_the_sun(drawer):
    """A ball is brightest towards the sun and darkest away from it."""
    ball = many(sphere_mesh(), Appearance((0.8, 0.8, 0.8), shininess=0.0), place((0, 0, -4)))
    sun = Sun(direction=Vec3(1, 0, -0.3), shadows=False)
    image = shot(drawer, ball, sun=sun).sum(axis=2)
    assert image[50, 62] > image[50, 80] > image[50, 98]


def test_lambert(drawer):
    """Half the light arrives on a surface tilted by 60 degrees."""
    grey = Appearance((0.5, 0.5, 0.5), shininess=0.0)
    sun = Sun(direction=Vec3(0, 0, -1), colour=(1, 1, 1), ambient=(0, 0, 0), shadows=False)
    tilted = place((0, 0, -5), Quat.from_axis_angle((0, 1, 0), np.pi / 3))
    full, half = (middle(shot(drawer, many(quad(), grey, at), sun=sun))[0] for at in (FRONT, tilted))
    assert abs(full - 128) <= 1
    light = ((np.array([full, half]) / 255 + 0.055) / 1.055) ** 2.4
    assert light[1] / light[0] == pytest.approx(0.5, abs=0.02)


def test_sky_light_is_brighter_from_above(drawer):
    """What looks up is lit by the sky, what looks down by the ground."""
    sun = Sun(colour=(0, 0, 0), shadows=False)
    image = shot(drawer, many(sphere_mesh(), Appearance((1, 1, 1)), place((0, 0, -4))), sun=sun).sum(axis=2)
    assert image[32, 80] > image[50, 80] > image[68, 80]


def test_polished_things_shine(drawer):
    """A highlight appears with shininess, and gets smaller and brighter with it."""
    bright = []
    for shininess in (0.0, 0.4, 1.0):
        ball = many(sphere_mesh(), Appearance((0.3, 0.3, 0.3), shininess=shininess), place((0, 0, -4)))
        image = shot(drawer, ball, sun=HEADLIGHT, sky=Sky((0, 0, 0), (0, 0, 0), None))
        bright.append(image.sum(axis=2))
    assert bright[0].max() < bright[1].max() < bright[2].max()
    spots = [np.count_nonzero(image > image.max() * 0.9) for image in bright]
    assert spots[2] < spots[1]


def test_polished_things_mirror_the_sky(drawer):
    """A steel ball takes colour from the sky."""
    ball = many(sphere_mesh(), Appearance((0.9, 0.9, 0.9), shininess=1.0), place((0, 0, -4)))
    dark = Sun(colour=(0, 0, 0), ambient=(0.1, 0.1, 0.1), shadows=False)
    red = shot(drawer, ball, sun=dark, sky=Sky((1, 0, 0), (1, 0, 0), None))[40, 80]
    assert red[0] > 3 * red[2]


def test_haze_takes_things_into_the_horizon(drawer):
    """Near things keep their colour, things at the haze's distance are almost the horizon's."""
    sky = Sky(horizon=(0.5, 0.6, 0.7), haze=100.0)
    horizon = np.array([0.5, 0.6, 0.7]) * 255
    near, far = (
        middle(shot(drawer, many(quad(), unlit(RED), place((0, 0, -z), scale=(z, z, 1))), sky=sky)) for z in (2, 100)
    )
    assert np.abs(near - (255, 0, 0)).max() < 12
    assert np.abs(far - horizon).max() < 30
    clear = shot(
        drawer, many(quad(), unlit(RED), place((0, 0, -100), scale=(100, 100, 1))), sky=replace(sky, haze=None)
    )
    assert middle(clear).tolist() == [255, 0, 0]


def test_sky_goes_from_horizon_to_zenith(drawer):
    """Level with the eye and below is the horizon's colour, straight up almost the zenith's."""
    sky, night = Sky((0, 0, 1), (1, 1, 1), None), Sun(colour=(0, 0, 0))
    level = shot(drawer, sky=sky, sun=night)
    assert (level[52:] == 255).all()
    assert (np.diff(level[:50, 80, 0]) >= 0).all()
    up = View(Pose(rotation=Quat.from_axis_angle((1, 0, 0), np.pi / 2)))
    assert middle(shot(drawer, view=up, sky=sky, sun=night))[0] < 60


def test_the_sun_is_in_the_sky(drawer):
    """Looking against the light, one sees where it comes from."""
    sky = Sky((0, 0, 0.3), (0, 0, 0.3), None)
    image = shot(drawer, sky=sky, sun=Sun(direction=Vec3(0, 0, 1)))
    assert middle(image).min() > 200
    assert image[5, 5, 0] < 100
