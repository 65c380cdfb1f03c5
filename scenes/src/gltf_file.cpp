// From a file to tinygltf's model.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string_view>

#include "gltf.h"

namespace estara {
namespace {

/// Walks through JSON text without keeping it, and says what is wrong with it: tinygltf takes the
/// last of two equal keys, and descends into nested values without end.
class JsonCheck : public nlohmann::json_sax<nlohmann::json> {
public:
    explicit JsonCheck(std::string_view text) : m_text(text) {}
    const std::string& problem() const noexcept { return m_problem; }
    /// The strings of the file's "extensionsRequired".
    const std::vector<std::string>& required() const noexcept { return m_required; }

    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(number_integer_t) override { return true; }
    bool number_unsigned(number_unsigned_t) override { return true; }
    bool number_float(number_float_t, const string_t&) override { return true; }
    bool binary(binary_t&) override { return true; }
    bool start_object(std::size_t) override { return open(); }
    bool start_array(std::size_t) override { return open(); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool string(string_t& text) override {
        if (m_keys.size() == 2 && m_section == "extensionsRequired") m_required.push_back(text);
        return true;
    }

    bool key(string_t& name) override {
        if (m_keys.size() == 1) m_section = name;
        if (m_keys.back().insert(name).second) return true;
        m_problem = fmt::format("the key \"{}\" is given twice", one_line(name));
        return false;
    }

    bool parse_error(std::size_t position, const std::string& last,
                     const nlohmann::detail::exception&) override {
        const std::size_t start = m_text.find_first_not_of(" \t\r\n");
        const std::string_view before = m_text.substr(0, position);
        if (start == m_text.npos) {
            m_problem = "the file is empty";
        } else if (m_text[start] != '{') {
            m_problem = "not glTF: it starts neither with { nor as a .glb does";
        } else {
            m_problem =
                fmt::format("broken JSON in line {}, near '{}'",
                            1 + std::count(before.begin(), before.end(), '\n'), one_line(last));
        }
        return false;
    }

private:
    bool open() {
        constexpr std::size_t deepest = 200;
        m_keys.emplace_back();
        if (m_keys.size() <= deepest) return true;
        m_problem = fmt::format("JSON nested more than {} deep", deepest);
        return false;
    }
    bool close() {
        m_keys.pop_back();
        return true;
    }

    std::string_view m_text;
    std::vector<std::set<std::string>> m_keys;
    std::string m_problem, m_section;  ///< the outermost key
    std::vector<std::string> m_required;
};

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (int k = 3; k >= 0; --k) {
        value = (value << 8) | static_cast<unsigned char>(bytes[at + std::size_t(k)]);
    }
    return value;
}

/// The JSON of a .glb, whose frame it checks.
std::string_view json_of_binary(const std::string& path, std::string_view file) {
    constexpr std::size_t header = 20;  // magic, version, length; length and type of the JSON
    if (file.size() < header) {
        throw Error(
            fmt::format("{}: truncated: {} bytes are too short for a .glb", path, file.size()));
    }
    const std::uint32_t version = little_endian(file, 4);
    if (version != 2) {
        throw Error(fmt::format("{}: glTF version {}; this reads version 2", path, version));
    }
    const std::uint32_t whole = little_endian(file, 8), json = little_endian(file, 12);
    if (whole > file.size()) {
        throw Error(fmt::format("{}: truncated: its header says {} bytes, the file has {}", path,
                                whole, file.size()));
    }
    if (whole < header || json > whole - header) {
        throw Error(fmt::format("{}: damaged: {} bytes of JSON do not fit into {} bytes", path,
                                json, whole));
    }
    return file.substr(header, json);
}

/// Extensions that change only what is not shown anyway (textures, metallic materials), or that
/// are read.
bool is_supported(const std::string& extension) {
    const auto begins_with = [&](std::string_view head) { return extension.starts_with(head); };
    return extension == "KHR_lights_punctual" || extension == "KHR_mesh_quantization" ||
           extension == "EXT_mesh_gpu_instancing" || extension == "KHR_node_visibility" ||
           begins_with("KHR_materials_") || begins_with("KHR_texture_") ||
           begins_with("EXT_texture_");
}

/// Before tinygltf parses: what a required extension changes may be what it stumbles at.
void check_extensions(const std::string& path, const std::vector<std::string>& required) {
    std::vector<std::string> missing;
    for (const std::string& name : required) {
        if (!is_supported(name)) missing.push_back(one_line(name));
    }
    if (missing.empty()) return;
    throw Error(fmt::format("{}: it requires {}, which is not supported; export it without", path,
                            fmt::join(missing, ", ")));
}

/// A primitive's accessors without data of their own, though a compressed form stands beside them.
/// tinygltf says "invalid bufferView" of some of them, and takes others for zeros.
void check_compression(const std::string& path, std::string_view text) {
    if (text.find("_compression") == std::string_view::npos) return;
    const nlohmann::json file = nlohmann::json::parse(text.begin(), text.end(), nullptr, false);
    if (!file.is_object()) return;
    const auto at = [](const nlohmann::json& of, const char* key) {
        return of.is_object() && of.contains(key) ? of[key] : nlohmann::json();
    };
    const nlohmann::json accessors = at(file, "accessors");
    for (const nlohmann::json& mesh : at(file, "meshes")) {
        for (const nlohmann::json& primitive : at(mesh, "primitives")) {
            const nlohmann::json index = at(at(primitive, "attributes"), "POSITION");
            const bool compressed =
                at(primitive, "extensions").contains("KHR_draco_mesh_compression");
            if (!compressed || !index.is_number_unsigned()) continue;
            const auto position = index.get<std::size_t>();
            if (!accessors.is_array() || position >= accessors.size() ||
                accessors[position].contains("bufferView")) {
                continue;
            }
            const nlohmann::json name = at(mesh, "name");
            throw Error(fmt::format(
                "{}: mesh {}: compressed by KHR_draco_mesh_compression, which is not read; export "
                "it without compression",
                path, name.is_string() ? '"' + one_line(name.get<std::string>()) + '"' : "\"\""));
        }
    }
    for (const nlohmann::json& view : at(file, "bufferViews")) {
        for (const char* meshopt : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
            if (!at(view, "extensions").contains(meshopt)) continue;
            const nlohmann::json buffer = at(view, "buffer"), buffers = at(file, "buffers");
            const bool has_data = buffer.is_number_unsigned() && buffers.is_array() &&
                                  buffer.get<std::size_t>() < buffers.size() &&
                                  (buffers[buffer.get<std::size_t>()].contains("uri") ||
                                   buffer.get<std::size_t>() == 0);
            if (has_data) continue;
            throw Error(fmt::format(
                "{}: compressed by {}, which is not read; export it without compression", path,
                meshopt));
        }
    }
}

void check_json(const std::string& path, std::string_view text) {
    JsonCheck check(text);
    if (!nlohmann::json::sax_parse(text.begin(), text.end(), &check)) {
        throw Error(fmt::format("{}: {}", path, check.problem()));
    }
    check_extensions(path, check.required());
    check_compression(path, text);
}

/// What tinygltf left out, in one line. Not what it says of skins: these are not shown, and it
/// takes a property for necessary that is not.
std::string complaints(const std::string& problems) {
    std::istringstream lines(problems);
    std::string kept;
    for (std::string line; std::getline(lines, line);) {
        if (line.find("in Skin") == std::string::npos) kept += line + ' ';
    }
    return one_line(kept);
}

/// What tinygltf may read beside the scene, and why it was not let. Its own functions read from any
/// folder, from the current one too, and expand names as a shell does.
struct FilesBeside {
    std::filesystem::path folder;
    bool allow_outside;
    std::string problem;  ///< of the last file that was refused

    static FilesBeside& of(void* user) { return *static_cast<FilesBeside*>(user); }

    bool is_readable(const std::string& name) {
        std::error_code code;
        const std::filesystem::path file = std::filesystem::weakly_canonical(name, code);
        if (code || !std::filesystem::exists(file, code)) return false;
        const std::filesystem::path inside = file.lexically_relative(folder);
        const bool is_inside = !inside.empty() && *inside.begin() != "..";
        if (!is_inside && !allow_outside) {
            problem = fmt::format(
                "{}: lies outside the scene's folder and is not read; --allow-outside allows it",
                one_line(name, longest_name));
            return false;
        }
        if (std::filesystem::is_regular_file(file, code)) return true;
        problem = fmt::format("{}: is not a file", one_line(name, longest_name));
        return false;
    }
};

tinygltf::FsCallbacks callbacks_of(FilesBeside& files) {
    tinygltf::FsCallbacks callbacks{};
    callbacks.FileExists = [](const std::string& name, void* user) {
        return FilesBeside::of(user).is_readable(name);
    };
    callbacks.ExpandFilePath = [](const std::string& name, void*) { return name; };
    callbacks.ReadWholeFile = [](std::vector<unsigned char>* bytes, std::string* error,
                                 const std::string& name, void* user) {
        if (!FilesBeside::of(user).is_readable(name)) return false;
        try {
            const std::string read = read_file(name);
            bytes->assign(read.begin(), read.end());
            return true;
        } catch (const Error& why) {
            if (error) *error = why.what();
            return false;
        }
    };
    callbacks.WriteWholeFile = [](std::string*, const std::string&,
                                  const std::vector<unsigned char>&, void*) { return false; };
    callbacks.user_data = &files;
    return callbacks;
}

bool ignore_image(tinygltf::Image*, const int, std::string*, std::string*, int, int,
                  const unsigned char*, int, void*) {
    return true;
}

}  // namespace

std::string gltf_name(const char* kind, const std::string& name, std::size_t index) {
    return name.empty() ? fmt::format("{} {}", kind, index)
                        : fmt::format("{} \"{}\"", kind, one_line(name, longest_name));
}

void fail_no_element(const std::string& where, const char* what, int i, std::size_t count) {
    throw Error(fmt::format("{}: there is no {} {}; the file has {}, counted from 0", where, what,
                            i, count));
}

tinygltf::Model parse_gltf(const std::string& path, bool allow_outside,
                           std::vector<std::string>& warnings) {
    const std::string file = read_file(path);
    if (file.size() > std::numeric_limits<std::uint32_t>::max()) {
        throw Error(fmt::format("{}: glTF files end at 4 GiB", path));
    }
    const bool is_binary = file.starts_with("glTF");
    const std::string_view json = is_binary ? json_of_binary(path, file) : file;
    check_json(path, json);

    tinygltf::TinyGLTF parser;
    parser.SetImageLoader(ignore_image, nullptr);
    const std::string folder = std::filesystem::path(path).parent_path().string();
    std::error_code code;
    FilesBeside files{
        std::filesystem::weakly_canonical(folder.empty() ? "." : folder, code), allow_outside, {}};
    parser.SetFsCallbacks(callbacks_of(files));
    parser.SetStoreOriginalJSONForExtrasAndExtensions(true);
    tinygltf::Model model;
    std::string problems, remarks;
    const std::uint32_t size = std::uint32_t(file.size());
    bool ok = false;
    try {
        ok = is_binary ? parser.LoadBinaryFromMemory(
                             &model, &problems, &remarks,
                             reinterpret_cast<const unsigned char*>(file.data()), size, folder)
                       : parser.LoadASCIIFromString(&model, &problems, &remarks, file.data(), size,
                                                    folder);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& exception) {
        problems = exception.what();
    }
    if (!ok && !files.problem.empty()) throw Error(fmt::format("{}: {}", path, files.problem));
    if (!ok) throw Error(fmt::format("{}: cannot be read as glTF: {}", path, one_line(problems)));
    if (const std::string left_out = complaints(problems); !left_out.empty()) {
        warnings.push_back(fmt::format("{}: in part not glTF, and left out: {}", path, left_out));
    }
    return model;
}

}  // namespace estara
