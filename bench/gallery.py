#!/usr/bin/env python3
"""Makes the pictures of the documentation: surfaces before and after, side by side, into docs/images.

usage: gallery.py [--data FOLDER] [NAME...]       names: clean dirty cloud smoke cad stages sequence report
Needs numpy and the module isoshell; `sequence` also Pillow, and `report` playwright with chromium. FOLDER holds three
files that are not part of the project: elephant_holes.off and kitten.xyz (CGAL's data, CC0) and fandisk.off (the same);
what lacks its file is left out.
"""
import argparse
import os
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

import isoshell
from render import read_mesh, render, write_png

ROOT = Path(__file__).resolve().parents[1]
SIZE = 460


def picture(mesh, view, up=(0, 1, 0), edges=True, zoom=1):
    vertices, faces, colours, curves = mesh
    return render(vertices, faces, colours, curves, SIZE, np.array(view, float), np.array(up, float), zoom, edges)


def remeshed(source, **options):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "out.ply")
        isoshell.remesh(source, output=path, quiet=True, **options)
        return read_mesh(path)


def side_by_side(name, *images):
    write_png(ROOT / f"docs/images/gallery_{name}.png", np.concatenate(images, axis=1) | 3)  # packs a third better


def octahedra(points, radius):
    """A small solid around every point, to see points with."""
    corners = radius * np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)])
    faces = np.array([(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)])
    vertices = (points[:, None, :] + corners).reshape(-1, 3)
    return vertices, (faces + 6 * np.arange(len(points))[:, None, None]).reshape(-1, 3), None, set()


def plume(n=72):
    """A made plume of smoke: puffs along a winding path, thinner the higher they are."""
    axis = np.linspace(-1, 1, n)
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    density = np.zeros((n, n, n))
    random = np.random.default_rng(7)
    for t in np.linspace(0, 1, 46):
        centre = np.array([.25 * np.sin(5 * t), 1.6 * t - .8, .25 * np.cos(4 * t)]) + random.normal(0, .03 + .16 * t, 3)
        width = .07 + .11 * t
        density += np.exp(-((x - centre[0]) ** 2 + (y - centre[1]) ** 2 + (z - centre[2]) ** 2) / width ** 2)
    return density


def seen_through(density):
    """The density as smoke before a light ground, seen along z."""
    light = np.exp(-.06 * density.sum(axis=2)).T[::-1]
    rows = (np.arange(SIZE) * light.shape[0] / SIZE).astype(int)
    grey = 90 + 165 * light[rows][:, rows]
    return np.repeat(grey[:, :, None], 3, axis=2).astype(np.uint8)


def clean(_):
    path, view = str(ROOT / "tests/data/nefertiti.ply"), (.45, .1, 1)
    before = picture(read_mesh(path), view, edges=False)
    side_by_side("clean", before, picture(remeshed(path, vertices=3000), view))


def dirty(data):
    path, view = str(data / "elephant_holes.off"), (1, .25, .6)
    side_by_side("dirty", picture(read_mesh(path), view), picture(remeshed(path, vertices=3000), view))


def cloud(data):
    path, view = str(data / "kitten.xyz"), (.6, .2, 1)
    points = np.loadtxt(path)[:, :3]
    before = picture(octahedra(points, .006 * np.ptp(points, axis=0).max()), view, edges=False)
    side_by_side("cloud", before, picture(remeshed(path, vertices=2500), view))


def smoke(_):
    density, n = plume(), 72
    volume = isoshell.Volume(density, spacing=2 / (n - 1), origin=-1)
    after = picture(remeshed(volume, iso=.5, vertices=3000), (0, 0, 1), zoom=.8)
    side_by_side("smoke", seen_through(density), after)


def cad(data):
    path, view = str(data / "fandisk.off"), (-.6, .5, 1)
    after = remeshed(path, vertices=3000, color_features=True)
    side_by_side("cad", picture(read_mesh(path), view), picture(after, view))


def stages(_):
    """The sheet that the voxels of a scan bound, its Voronoi cells, and their dual."""
    path, view = str(ROOT / "tests/data/nefertiti.ply"), (.45, .1, 1)
    made = isoshell.Stages(path, vertices=500, features="off").prepare().relax()
    vertices, faces = made.sheet
    middles, seeds = vertices[faces].mean(axis=1), made.seeds
    nearest = np.concatenate([((m[:, None] - seeds) ** 2).sum(axis=2).argmin(axis=1)
                              for m in np.array_split(middles, len(middles) // 2000 + 1)])
    colours = np.random.default_rng(1).integers(110, 250, (len(seeds), 3))[nearest]
    result = made.triangulate()
    side_by_side("stages", picture((vertices, faces, None, set()), view),
                 picture((vertices, faces, colours, set()), view, edges=False),
                 picture((result.vertices, result.faces, None, set()), view))


def turned(vertices, degrees):
    """A bust whose head is turned by so much, and its neck by less the lower."""
    height = vertices[:, 1]
    share = ((height - height.min()) / np.ptp(height) * 2.5 - .35).clip(0, 1)
    angle = np.radians(degrees) * share ** 2 * (3 - 2 * share)
    x, z = vertices[:, 0], vertices[:, 2]
    return np.stack([np.cos(angle) * x + np.sin(angle) * z, height, np.cos(angle) * z - np.sin(angle) * x], axis=1)


def sequence(_):
    """A film: every frame meshed anew, beside the same frames as a sequence. Every twelfth number of a vertex has a
    colour, which the faces around that vertex have."""
    from PIL import Image

    vertices, faces, _, _ = read_mesh(str(ROOT / "tests/data/nefertiti.ply"))
    frames = [(turned(vertices, 45 * np.sin(2 * np.pi * t / 20)), faces) for t in range(20)]
    framed, view, up, film = np.concatenate([v for v, _ in frames[::5]]), (.1, .1, 1.), (0, 1., 0), []
    tones = [(232, 116, 97), (96, 158, 214), (240, 186, 80), (120, 184, 110)]
    colours = np.random.default_rng(3).permutation(tones * 17)
    for pair in zip(*(isoshell.remesh_sequence(frames, vertices=800, features="off", no_coherence=anew)
                      for anew in (True, False))):
        images = []
        for result in pair:
            number = np.where(result.faces % 12 == 0, result.faces // 12, -1).max(axis=1)
            of_faces = np.where(number[:, None] < 0, (222, 227, 234), colours[number])
            image = render(result.vertices, result.faces, of_faces, set(), SIZE - 110, np.array(view), np.array(up), 1,
                           True, framed)
            images.append(image[:, 45:-45])
        film.append(Image.fromarray(np.concatenate(images, axis=1)))
    film[0].save(ROOT / "docs/images/gallery_sequence.webp", save_all=True, append_images=film[1:], duration=120,
                 loop=0, quality=50, method=6)


def report(data):
    """The page of a part, coloured by its deviation, as a browser shows it."""
    from PIL import Image
    from playwright.sync_api import sync_playwright

    source = data / "fandisk.off"
    source.stat()  # or it is left out
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as started:
        page_file, shot = Path(folder, "page.html"), Path(folder, "shot.png")
        isoshell.remesh(str(source), vertices=4000, report=page_file, quiet=True)
        browser = started.chromium.launch(executable_path=shutil.which("chromium"), args=[
            "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"])
        page = browser.new_page(viewport={"width": 1100, "height": 750})
        page.goto(page_file.as_uri())
        page.get_by_text("Deviation", exact=True).first.click()
        page.wait_for_timeout(5000)  # it draws
        page.screenshot(path=shot)
        browser.close()
        Image.open(shot).convert("RGB").quantize(128).save(ROOT / "docs/images/report_fandisk.png", optimize=True)


def main():
    args = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    args.add_argument("--data", type=Path, default=Path("."))
    args.add_argument("names", nargs="*")
    a = args.parse_args()
    for make in (clean, dirty, cloud, smoke, cad, stages, sequence, report):
        if not a.names or make.__name__ in a.names:
            try:
                make(a.data)
            except FileNotFoundError as error:
                print(f"{make.__name__} is left out: {error.filename} is not there", file=sys.stderr)


if __name__ == "__main__":
    main()
