// Numbers out of glTF buffers.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "gltf.h"

namespace estara {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are little endian");

/// Elements in a buffer, checked: element i is `size` bytes at data + i * stride.
struct Elements {
    const unsigned char* data;
    std::size_t stride;
};

std::size_t component_size(int type, const std::string& where) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            throw Error(fmt::format("{}: component type {} is none of glTF's", where, type));
    }
}

Elements elements(const tinygltf::Model& model, int view_index, std::size_t offset,
                  std::size_t count, std::size_t size, const std::string& where) {
    const tinygltf::BufferView& view =
        gltf_element(model.bufferViews, view_index, where, "buffer view");
    const std::vector<unsigned char>& data =
        gltf_element(model.buffers, view.buffer, where, "buffer").data;
    const std::size_t stride = view.byteStride == 0 ? size : view.byteStride;
    // Written so that no sum can overflow.
    const bool view_fits =
        view.byteOffset <= data.size() && view.byteLength <= data.size() - view.byteOffset;
    const bool fits = view_fits && offset <= view.byteLength && size <= view.byteLength - offset &&
                      count - 1 <= (view.byteLength - offset - size) / stride;
    if (!fits) {
        throw Error(fmt::format("{}: {} elements reach beyond their buffer; is it truncated?",
                                where, count));
    }
    return {data.data() + view.byteOffset + offset, stride};
}

template <class T>
T load(const unsigned char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

/// glTF 2.0, 3.6.2.2, "Accessor Data Types", and 3.11 for what normalised integers mean.
float decode(const unsigned char* bytes, int type, bool normalized) {
    const auto scaled = [normalized](float value, float largest) {
        return normalized ? std::max(value / largest, -1.0f) : value;
    };
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return scaled(load<std::int8_t>(bytes), 127.0f);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return scaled(load<std::uint8_t>(bytes), 255.0f);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return scaled(load<std::int16_t>(bytes), 32767.0f);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return scaled(load<std::uint16_t>(bytes), 65535.0f);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return float(load<std::uint32_t>(bytes));
        default:
            return load<float>(bytes);
    }
}

std::uint32_t decode_index(const unsigned char* bytes, int type, const std::string& where) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return load<std::uint8_t>(bytes);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return load<std::uint16_t>(bytes);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return load<std::uint32_t>(bytes);
        default:
            throw Error(fmt::format("{}: indices must be unsigned integers", where));
    }
}

void copy_floats(const Elements& from, std::size_t element, const tinygltf::Accessor& accessor,
                 int components, std::size_t size, float* to) {
    for (int c = 0; c < components; ++c) {
        to[c] = decode(from.data + element * from.stride + std::size_t(c) * size,
                       accessor.componentType, accessor.normalized);
    }
}

/// Overwrites the elements that a sparse accessor names.
void apply_sparse(const tinygltf::Model& model, const tinygltf::Accessor& accessor, int components,
                  const std::string& where, std::vector<float>& values) {
    const auto& sparse = accessor.sparse;
    if (sparse.count < 1 || std::size_t(sparse.count) > accessor.count ||
        sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0) {
        throw Error(
            fmt::format("{}: {} sparse elements of {}", where, sparse.count, accessor.count));
    }
    const std::size_t count = std::size_t(sparse.count);
    const std::size_t index_size = component_size(sparse.indices.componentType, where);
    const std::size_t size = component_size(accessor.componentType, where);
    const Elements indices =
        elements(model, sparse.indices.bufferView, std::size_t(sparse.indices.byteOffset), count,
                 index_size, where);
    const Elements replaced =
        elements(model, sparse.values.bufferView, std::size_t(sparse.values.byteOffset), count,
                 size * std::size_t(components), where);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t at =
            decode_index(indices.data + i * indices.stride, sparse.indices.componentType, where);
        if (at >= accessor.count) {
            throw Error(fmt::format("{}: sparse index {} is out of range; there are {} elements",
                                    where, at, accessor.count));
        }
        copy_floats(replaced, i, accessor, components, size,
                    values.data() + std::size_t(at) * std::size_t(components));
    }
}

void check_finite(const std::vector<float>& values, int components, const std::string& where) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::isfinite(values[i])) continue;
        throw Error(fmt::format("{} {}: {} is not a finite number", where,
                                i / std::size_t(components), values[i]));
    }
}

}  // namespace

std::vector<float> read_floats(const tinygltf::Model& model, int index, int components,
                               const std::string& where) {
    const tinygltf::Accessor& accessor = gltf_element(model.accessors, index, where, "accessor");
    const int found = tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type));
    if (found != components) {
        throw Error(
            fmt::format("{}: {} numbers an element; it needs {}", where, found, components));
    }
    const std::size_t size = component_size(accessor.componentType, where);
    if (accessor.count == 0) return {};
    // One that is not in a buffer is all zeros, and costs the file nothing: bounded by our choice.
    constexpr std::size_t most_zeros = std::size_t{1} << 26;
    if (accessor.bufferView < 0 && accessor.count > most_zeros) {
        throw Error(fmt::format("{}: {} elements without a buffer; at most {} are read", where,
                                accessor.count, most_zeros));
    }
    std::vector<float> values;
    if (accessor.bufferView >= 0) {
        const Elements from = elements(model, accessor.bufferView, accessor.byteOffset,
                                       accessor.count, size * std::size_t(components), where);
        values.resize(accessor.count * std::size_t(components));
        for (std::size_t i = 0; i < accessor.count; ++i) {
            copy_floats(from, i, accessor, components, size,
                        values.data() + i * std::size_t(components));
        }
    } else {
        values.resize(accessor.count * std::size_t(components));
    }
    if (accessor.sparse.isSparse) apply_sparse(model, accessor, components, where, values);
    check_finite(values, components, where);
    return values;
}

std::vector<std::uint32_t> read_indices(const tinygltf::Model& model, int index,
                                        const std::string& where) {
    const tinygltf::Accessor& accessor = gltf_element(model.accessors, index, where, "accessor");
    if (accessor.type != TINYGLTF_TYPE_SCALAR || accessor.sparse.isSparse) {
        throw Error(fmt::format("{}: indices must be single numbers, and not sparse", where));
    }
    if (accessor.count == 0) return {};
    const std::size_t size = component_size(accessor.componentType, where);
    const Elements from =
        elements(model, accessor.bufferView, accessor.byteOffset, accessor.count, size, where);
    std::vector<std::uint32_t> values(accessor.count);
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = decode_index(from.data + i * from.stride, accessor.componentType, where);
    }
    return values;
}

}  // namespace estara
