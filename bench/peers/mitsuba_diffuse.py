#!/usr/bin/env python3
"""A scene's diffuse light by hemiray's radiosity against Mitsuba 3's path tracer, block by block of the picture.

  python3 -m venv v && v/bin/pip install mitsuba numpy
  v/bin/python bench/peers/mitsuba_diffuse.py scenes/cornell_box.json --hemiray build/release/hemiray

Reads the part of the JSON format in which light is diffuse and every surface has patches: quads, meshes in the file,
spheres; kd; visible area and point lights. Anything else is refused. The scene's ambient light is left out.
Exit code: 0; 2 input; 3 the root mean square of the blocks' differences is above the mesh error that hemiray reports
plus Mitsuba's 95 % interval.
"""
import argparse
import json
import math
import pathlib
import shlex
import subprocess
import sys
import tempfile

try:
    import mitsuba as mi
    import numpy as np
except ImportError as missing:
    sys.exit(f"mitsuba_diffuse.py: {missing}; install it with: pip install mitsuba numpy")


class Refused(Exception):
    pass


def only(keys, thing, where):
    for key in thing.keys() - keys - {"type", "name"}:
        raise Refused(f"{where}: '{key}' is not read here")


def rgb(value):
    return [float(v) for v in value] if isinstance(value, list) else [float(value)] * 3


def lambert(material, where):
    only({"kd"}, material, where)
    reflectance = {"type": "rgb", "value": rgb(material.get("kd", 0.5))}
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": reflectance}}


def parallelogram(thing):
    corner, u, v = (np.array(thing[key], float) for key in ("corner", "edge_u", "edge_v"))
    return [corner, corner + u, corner + u + v, corner + v]


def write_ply(path, vertices, polygons):
    with open(path, "w") as file:
        file.write("ply\nformat ascii 1.0\n" f"element vertex {len(vertices)}\n")
        file.write("".join(f"property float {axis}\n" for axis in "xyz"))
        file.write(f"element face {len(polygons)}\nproperty list uchar int vertex_indices\nend_header\n")
        file.writelines(" ".join(repr(float(x)) for x in vertex) + "\n" for vertex in vertices)
        file.writelines(f"{len(polygon)} " + " ".join(map(str, polygon)) + "\n" for polygon in polygons)


def triangles_of(thing, where):
    polygons = thing.get("polygons", []) + thing.get("triangles", [])
    if any(len(polygon) > 4 for polygon in polygons):
        raise Refused(f"{where}: a polygon of more than four corners")
    return [t for p in polygons for t in ([p] if len(p) == 3 else [[p[0], p[1], p[2]], [p[0], p[2], p[3]]])]


def shape_of(thing, path, where):
    """The dictionary of an object or area light without its material; writes meshes to `path`."""
    if thing["type"] == "sphere":
        only({"material", "center", "radius"}, thing, where)
        return {"type": "sphere", "center": thing["center"], "radius": float(thing["radius"])}
    if thing["type"] == "mesh":
        only({"material", "vertices", "polygons", "triangles"}, thing, where)
        write_ply(path, thing["vertices"], triangles_of(thing, where))
    elif thing["type"] in ("quad", "area"):
        only({"material", "vertices", "corner", "edge_u", "edge_v", "radiance", "samples", "jitter"}, thing, where)
        write_ply(path, thing.get("vertices") or parallelogram(thing), [[0, 1, 2], [0, 2, 3]])
    else:
        raise Refused(f"{where}: objects of type '{thing['type']}' are not read here")
    return {"type": "ply", "filename": str(path), "face_normals": True}


def to_mitsuba(scene, size, folder):
    camera = scene["camera"]
    only({"position", "look_at", "up", "fov", "size"}, camera, "/camera")
    if any(rgb(scene.get("background", 0))):
        raise Refused("/background: radiosity gets no light from it")
    film = {"type": "hdrfilm", "width": size[0], "height": size[1], "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    to_world = mi.ScalarTransform4f().look_at(camera["position"], camera["look_at"], camera.get("up", [0, 1, 0]))
    result = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": -1, "rr_depth": 8},
        "camera": {"type": "perspective", "fov": camera.get("fov", 45.0), "fov_axis": "y", "near_clip": 1e-4,
                   "to_world": to_world, "film": film, "sampler": {"type": "independent"}},
    }
    materials = {n: lambert(m, f"/materials/{n}") for n, m in scene.get("materials", {}).items()}
    for i, thing in enumerate(scene["objects"]):
        shape = shape_of(thing, folder / f"object{i}.ply", f"/objects/{i}")
        shape["bsdf"] = materials[thing["material"]] if "material" in thing else lambert({}, "")
        result[f"object{i}"] = shape
    for i, light in enumerate(scene.get("lights", [])):
        where = f"/lights/{i}"
        if light["type"] == "point":
            only({"position", "intensity"}, light, where)
            result[f"light{i}"] = {"type": "point", "position": light["position"],
                                   "intensity": {"type": "rgb", "value": rgb(light["intensity"])}}
        elif light["type"] == "area":
            shape = shape_of(light, folder / f"light{i}.ply", where)
            shape["bsdf"] = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}
            shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": rgb(light["radiance"])}}
            result[f"light{i}"] = shape
        else:
            raise Refused(f"{where}: lights of type '{light['type']}' are not read here")
    return result


def block_means(picture, block):
    h, w, c = picture.shape
    return picture.reshape(h // block, block, w // block, block, c).mean(axis=(1, 3))


def read_beauty(path):
    bitmap = mi.Bitmap(str(path))
    names = [field.name for field in bitmap.struct_()]
    return np.array(bitmap, dtype=np.float64)[:, :, [names.index(channel) for channel in "RGB"]]


def main():
    parse = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parse.add_argument("scene", help="JSON scene")
    parse.add_argument("--hemiray", default="./hemiray", help="the program (default ./hemiray)")
    parse.add_argument("--size", type=int, default=128, help="pixels along an edge of the picture (default 128)")
    parse.add_argument("--block", type=int, default=8, help="pixels along an edge of a block (default 8)")
    parse.add_argument("--passes", type=int, default=8, help="pictures of Mitsuba, whose spread is its error (default 8)")
    parse.add_argument("--spp", type=int, default=32, help="samples a pixel of each (default 32)")
    parse.add_argument("--variant", default="scalar_rgb", help="of Mitsuba (default scalar_rgb)")
    parse.add_argument("--with", dest="more", default="", metavar="OPTIONS",
                       help="of hemiray's radiosity: --with='--patches 10000'")
    given = parse.parse_args()
    if given.size % given.block or given.passes < 2:
        parse.error("--size must be a multiple of --block, and --passes at least 2")
    mi.set_variant(given.variant)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        try:
            with open(given.scene) as file:
                described = to_mitsuba(json.load(file), [given.size, given.size], folder)
        except (Refused, OSError, ValueError, KeyError) as problem:
            print(f"mitsuba_diffuse.py: {given.scene}: {problem}", file=sys.stderr)
            return 2
        scene = mi.load_dict(described)
        passes = [block_means(np.array(mi.render(scene, spp=given.spp, seed=seed), dtype=np.float64), given.block)
                  for seed in range(given.passes)]
        command = [given.hemiray, "render", given.scene, "-o", str(folder / "a.exr"), "--method", "radiosity",
                   "--size", f"{given.size}x{given.size}", "--spp", "16", "--json", *shlex.split(given.more)]
        ran = subprocess.run(command, stdout=subprocess.PIPE, check=False)
        if ran.returncode:
            return ran.returncode
        report = json.loads(ran.stdout)["radiosity"]
        ours = block_means(read_beauty(folder / "a.exr"), given.block)
    return compare(ours, np.array(passes), report)


def compare(ours, passes, report):
    theirs = passes.mean(axis=0)
    # The lamp is seen as it is, and mixed with the ceiling at its edge: blocks of it say nothing of the mesh.
    seen = (theirs.max(axis=2) > 0) & (theirs.max(axis=2) < 10 * np.median(theirs.max(axis=2)))
    difference = (ours - theirs)[seen]
    interval = 1.96 * (passes.std(axis=0, ddof=1) / math.sqrt(len(passes)))[seen]
    rms = lambda values: math.sqrt((values ** 2).mean())
    mesh = report["continuous_residual"]["rms_high"] / math.pi
    redness = lambda picture: picture[seen][:, 0] / picture[seen][:, 1]
    ratio = redness(ours) / redness(theirs)
    print(f"Mitsuba {mi.__version__}, {report['patches']} patches, {seen.sum()} blocks of {seen.size}; W/m^2/sr")
    print(f"blocks        root mean square {rms(theirs[seen]):.4g}, of the differences {rms(difference):.3g}")
    print(f"Mitsuba       95 % interval +-{rms(interval):.2g}; mean difference {difference.mean():+.2g}")
    print(f"mesh error    {mesh:.3g} reported, of the solution that is constant on each patch")
    print(f"red / green   of ours over Mitsuba's: median {np.median(ratio):.4f}, from {ratio.min():.3f} to {ratio.max():.3f}")
    if rms(difference) <= mesh + rms(interval):
        return 0
    print("FAILS: beyond the mesh error", file=sys.stderr)
    return 3


if __name__ == "__main__":
    sys.exit(main())
