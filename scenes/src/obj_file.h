// What a Wavefront OBJ file says, line by line. Private to this folder.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "loaders.h"

namespace estara {

/// A corner of a face: indices into the file's lists, from 0; -1: not given.
struct ObjCorner {
    std::int32_t position = -1, uv = -1, normal = -1;
};

struct ObjFace {
    std::uint32_t first = 0, count = 0;  ///< of ObjFile::corners
    int part = 0;                        ///< of ObjFile::parts
    int smoothing = 0;                   ///< its group; 0: it is flat
    std::int64_t line = 0;
};

/// An object or group and a material of its faces.
struct ObjPart {
    std::string name;      ///< "": the file names none
    std::string material;  ///< "": none
};

struct ObjFile {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> uvs;
    std::vector<ObjCorner> corners;
    std::vector<ObjFace> faces;
    std::vector<ObjPart> parts;  ///< in the order of their first faces
    std::vector<std::string> material_files;
    bool has_smoothing = false;  ///< whether any line speaks of smoothing groups
    int lines_and_points = 0, curves = 0, colours = 0;  ///< what is not shown
};

/// Ours, because tinyobjloader takes "nan" for 0, leaves out faces whose indices are wrong, splits
/// concave quadrilaterals outside and stops at continued lines, comments behind values and "1//".
/// Error with the line for a number or index that is none, or is out of range.
ObjFile parse_obj(const std::string& path, std::string_view text);

}  // namespace estara
