"""Renders the scene that renderers.cpp describes with Blender's Cycles.

blender --background --factory-startup --python cycles.py -- DESCRIPTION (MATERIAL PICTURE)...

Direct light alone with hard shadows, a box filter of one pixel, neither denoising nor adaptive
sampling; the rest as Blender has it: a ray to one of the lights a sample. Blender's watts are watts
per steradian times 4 pi.
"""
import json
import math
import sys

import bpy
import mathutils


def matrix(position, right, up, back):
    return mathutils.Matrix((*zip(right, up, back, position), (0, 0, 0, 1)))


def add_camera(scene, camera):
    lens = bpy.data.cameras.new("camera")
    lens.sensor_fit = "VERTICAL"
    lens.angle = camera["yfov"]
    lens.clip_end = 1000
    node = bpy.data.objects.new("camera", lens)
    node.matrix_world = matrix(camera["eye"], camera["right"], camera["up"],
                               [-x for x in camera["forward"]])
    scene.collection.objects.link(node)
    scene.camera = node


def add_light(scene, light):
    lamp = bpy.data.lights.new("light", "SPOT" if light["spot"] else "POINT")
    strength = max(light["color"])
    lamp.color = [c / strength for c in light["color"]]
    lamp.energy = strength * 4 * math.pi
    lamp.shadow_soft_size = 0
    if light["spot"]:
        lamp.spot_size = 2 * light["outer"]
        lamp.spot_blend = 1 - light["inner"] / light["outer"]
    node = bpy.data.objects.new("light", lamp)
    back = -mathutils.Vector(light["direction"])
    right = back.orthogonal().normalized()
    node.matrix_world = matrix(light["position"], right, back.cross(right), back)
    scene.collection.objects.link(node)


def material(name):
    """constant: one diffuse colour; noise: 29 octaves in two textures, as many as greenmarble."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (0.8, 0.8, 0.8, 1)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(diffuse.outputs["BSDF"], output.inputs["Surface"])
    if name == "noise":
        mix = tree.nodes.new("ShaderNodeMixRGB")
        place = tree.nodes.new("ShaderNodeTexCoord")
        for detail, socket in ((14, "Fac"), (13, "Color1")):
            noise = tree.nodes.new("ShaderNodeTexNoise")
            noise.inputs["Detail"].default_value = detail
            tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
            tree.links.new(noise.outputs["Fac"], mix.inputs[socket])
        tree.links.new(mix.outputs["Color"], diffuse.inputs["Color"])
    return made


def main(description, *pictures):
    with open(description) as file:
        wanted = json.load(file)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.obj_import(filepath=wanted["obj"], forward_axis="Y", up_axis="Z")
    scene = bpy.context.scene
    add_camera(scene, wanted["camera"])
    for light in wanted["lights"]:
        add_light(scene, light)
    render = scene.render
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = wanted["width"], wanted["height"]
    render.threads_mode, render.threads = "FIXED", wanted["threads"]
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.samples = wanted["spp"]
    cycles.max_bounces = 0
    cycles.use_denoising = False
    cycles.use_adaptive_sampling = False
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1
    for name, picture in zip(pictures[::2], pictures[1::2]):
        worn = material(name)
        for thing in bpy.data.objects:
            if thing.type == "MESH":
                thing.data.materials.clear()
                thing.data.materials.append(worn)
        render.filepath = picture
        bpy.ops.render.render(write_still=True)


main(*sys.argv[sys.argv.index("--") + 1:])
