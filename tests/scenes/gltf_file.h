// A glTF file made by a test: JSON with its buffer embedded.
#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace estara::test {

inline std::string base64(const std::string& bytes) {
    static constexpr const char* letters =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const bool inside = i + k < bytes.size();
            group = (group << 8) | (inside ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            const bool inside = i + k <= bytes.size();
            text += inside ? letters[(group >> (18 - 6 * k)) & 63] : '=';
        }
    }
    return text;
}

/// Component types of glTF.
template <class T>
constexpr int component_type() {
    if (std::is_same_v<T, std::int8_t>) return 5120;
    if (std::is_same_v<T, std::uint8_t>) return 5121;
    if (std::is_same_v<T, std::int16_t>) return 5122;
    if (std::is_same_v<T, std::uint16_t>) return 5123;
    if (std::is_same_v<T, std::uint32_t>) return 5125;
    return 5126;
}

/// Starts with one scene; what a test adds to `json` is written as it is.
class GltfFile {
public:
    using Json = nlohmann::json;
    Json json = {{"asset", {{"version", "2.0"}}},
                 {"scene", 0},
                 {"scenes", {{{"nodes", Json::array()}}}},
                 {"nodes", Json::array()},
                 {"meshes", Json::array()},
                 {"materials", Json::array()},
                 {"accessors", Json::array()},
                 {"bufferViews", Json::array()}};

    /// Adds bytes to the buffer; the index of their view.
    int view(const std::string& bytes) {
        while (m_bytes.size() % 4 != 0) m_bytes += '\0';
        json["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", m_bytes.size()}, {"byteLength", bytes.size()}});
        m_bytes += bytes;
        return int(json["bufferViews"].size()) - 1;
    }

    template <class T>
    static std::string bytes_of(const std::vector<T>& values) {
        std::string bytes(values.size() * sizeof(T), '\0');
        std::memcpy(bytes.data(), values.data(), bytes.size());
        return bytes;
    }

    /// Adds an accessor of "SCALAR", "VEC2", "VEC3" or "VEC4"; its index.
    template <class T>
    int accessor(const std::vector<T>& values, const std::string& type) {
        const std::size_t components = type == "SCALAR" ? 1 : std::size_t(type.back() - '0');
        json["accessors"].push_back({{"bufferView", view(bytes_of(values))},
                                     {"componentType", component_type<T>()},
                                     {"count", values.size() / components},
                                     {"type", type}});
        return int(json["accessors"].size()) - 1;
    }

    int add(const char* list, const Json& value) {
        json[list].push_back(value);
        return int(json[list].size()) - 1;
    }

    /// Adds a node that the scene shows; its index.
    int node(const Json& value) {
        const int index = add("nodes", value);
        json["scenes"][0]["nodes"].push_back(index);
        return index;
    }

    /// Adds a square in the xy plane, its mesh and a node that shows it; the index of the mesh.
    int square() {
        const int P = accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3");
        const int order = accessor<std::uint16_t>({0, 1, 2, 0, 2, 3}, "SCALAR");
        const int mesh = add(
            "meshes", {{"name", "square"},
                       {"primitives", {{{"attributes", {{"POSITION", P}}}, {"indices", order}}}}});
        node({{"name", "square node"}, {"mesh", mesh}});
        return mesh;
    }

    Json& primitive(int mesh) { return json["meshes"][std::size_t(mesh)]["primitives"][0]; }

    std::string text() {
        json["buffers"] = {{{"byteLength", m_bytes.size()},
                            {"uri", "data:application/octet-stream;base64," + base64(m_bytes)}}};
        return json.dump();
    }

    /// The same as .glb.
    std::string binary() {
        json["buffers"] = {{{"byteLength", m_bytes.size()}}};
        std::string text = json.dump(), bytes = m_bytes;
        while (text.size() % 4 != 0) text += ' ';
        while (bytes.size() % 4 != 0) bytes += '\0';
        const auto word = [](std::size_t value) {
            return bytes_of(std::vector<std::uint32_t>{std::uint32_t(value)});
        };
        return "glTF" + word(2) + word(28 + text.size() + bytes.size()) + word(text.size()) +
               "JSON" + text + word(bytes.size()) + std::string("BIN\0", 4) + bytes;
    }

private:
    std::string m_bytes;
};

}  // namespace estara::test
