// View-independent data of hit points, kept from frame to frame.
#pragma once

#include <glm/glm.hpp>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "estara/scenes/large_pages.h"
#include "estara/shaders/registry.h"

namespace estara {

/// What is kept of a hit point of one object: floats, in this order.
///
///     P (3)  N (3)  Ng (3)  baked...  [site (3)]  [E (3)  sides...]
///
/// All in object space, so that the point stays on an object that moves. N is the shading normal,
/// or the normal that the shader has perturbed it to; Ng the geometric one. `baked` are the floats
/// of the shader's Baked without its normal. An object that bends has P, N and Ng in the rest pose,
/// and the place on its mesh: the triangle's number as bits of a word, b1 and b2. E and sides are
/// there where neither lights nor objects move: diffuse irradiance / pi, and as bits of words,
/// first whether the point was seen from the side that Ng points to (E is that of this side), then
/// for each light whether it is visible. (With one colour and up to 31 lights a record is 64 bytes,
/// a line of the processor's cache.)
struct RecordLayout {
    int baked = 0;
    int lights = -1;     ///< of the scene; -1: E and sides are not kept
    bool bends = false;  ///< whether the site is kept

    static constexpr int P = 0, N = 3, Ng = 6, first_baked = 9;
    bool is_lit() const noexcept { return lights >= 0; }
    int words() const noexcept { return is_lit() ? lights / 32 + 1 : 0; }
    int site() const noexcept { return first_baked + baked; }
    int E() const noexcept { return site() + (bends ? 3 : 0); }
    int sides() const noexcept { return E() + 3; }
    int floats() const noexcept { return is_lit() ? sides() + words() : E(); }
};

/// First float of a shader's own normal in its baked record, or -1: it is the last channel.
int normal_plane(const ShaderInfo& info) noexcept;

/// The layout of a shader's records.
/// @param lights, bends  as RecordLayout has them
RecordLayout record_layout(const ShaderInfo& info, int lights, bool bends = false) noexcept;

/// A place on a mesh, and how a record keeps it.
struct Site {
    std::uint32_t triangle = 0;
    float b1 = 0.0f, b2 = 0.0f;

    static Site from(const float* record, const RecordLayout& layout) noexcept {
        const float* const r = record + layout.site();
        return {std::bit_cast<std::uint32_t>(r[0]), r[1], r[2]};
    }
    void put(float* record, const RecordLayout& layout) const noexcept {
        float* const r = record + layout.site();
        r[0] = std::bit_cast<float>(triangle);
        r[1] = b1;
        r[2] = b2;
    }
    glm::vec3 of(const std::vector<glm::vec3>& values, const glm::uvec3& t) const noexcept {
        return (1.0f - b1 - b2) * values[t.x] + b1 * values[t.y] + b2 * values[t.z];
    }
};

/// What a ray's hit point is known by: unique as long as the cache lives. Smaller is older.
struct RayId {
    std::uint64_t bits = ~std::uint64_t{0};

    static constexpr int index_bits = 11, page_bits = 32, born_bits = 20;
    RayId() = default;
    RayId(int born, std::uint32_t page, int index) noexcept
        : bits((std::uint64_t(born) << (index_bits + page_bits)) |
               (std::uint64_t(page) << index_bits) | std::uint64_t(index)) {}
    std::uint32_t page() const noexcept { return std::uint32_t(bits >> index_bits); }
    int index() const noexcept { return int(bits & ((1u << index_bits) - 1)); }
    int born() const noexcept {
        return int(bits >> (index_bits + page_bits) & ((1u << born_bits) - 1));
    }
};

/// A cache of fixed size with least-recently-used replacement (Knuth, "Sorting and Searching"; the
/// paper's section 3.3 asks for one).
///
/// Records live in pages of equal size; a page holds records of one instance, born in one frame. A
/// page is used in a frame in which any of its records serves the picture, and the page that has
/// not been used for longest is the next to be given away; one that is used in this frame never is.
/// A page that stays in view and of which next to nothing serves is given up without need: the
/// frames have other points there (or something in front), and to project it costs time.
/// Not thread-safe, but for reading, and for set_hidden() of different records.
class ReuseCache {
public:
    static constexpr std::size_t page_bytes = 16384;
    static constexpr int page_bits = 27;  ///< of a page's number
    /// Frames that a window can have, at most: what a RayId can tell apart.
    static constexpr int longest_window = (1 << RayId::born_bits) - 1;

    /// @param bytes    of memory for pages. Error (bad input) if not one fits
    /// @param layouts  by object; records of objects that are not cached are not added
    /// @param objects  by instance
    ReuseCache(std::uint64_t bytes, std::vector<RecordLayout> layouts, std::vector<int> objects);

    /// Forgets everything: a new window.
    void clear();

    /// The next frame begins: frames are counted from 0 since clear(). Pages that mark_used() names
    /// from now on stay until the next one.
    void start_frame();
    int frame() const noexcept { return m_frame; }

    const RecordLayout& layout(int instance) const noexcept {
        return m_layouts[std::size_t(m_objects[std::size_t(instance)])];
    }

    /// A page of records, one after the other, and beside them as structure of arrays what every
    /// frame reads of every record.
    struct alignas(64) Page {
        int instance = -1;  ///< -1: free
        int size = 0;       ///< records in it
        int born = 0, used = 0;
        int serving = 0;  ///< records that serve this frame
        int idle = 0;     ///< frames in view in which few of its records have served
        glm::vec3 low{0.0f}, high{0.0f};  ///< bounds of P
        int capacity = 0, floats = 0;     ///< records that fit, and floats of each
        float* memory = nullptr;

        float* record(int index) const noexcept { return memory + index * floats; }
        float* P(int c) const noexcept { return record(capacity) + c * capacity; }
        std::uint8_t* hidden() const noexcept { return reinterpret_cast<std::uint8_t*>(P(3)); }
    };
    /// Pages that have been in use since clear(); no other has a higher number.
    int page_count() const noexcept { return m_touched; }
    const Page& page(std::uint32_t p) const noexcept { return m_pages[p]; }
    Page& page(std::uint32_t p) noexcept { return m_pages[p]; }

    /// Notes whether something is in front of the point.
    void set_hidden(RayId id, bool hidden) noexcept {
        m_pages[id.page()].hidden()[id.index()] = hidden ? 1 : 0;
    }

    /// So many records of a page serve this frame.
    void mark_used(std::uint32_t page, int records) noexcept {
        m_pages[page].used = m_frame;
        m_pages[page].serving = records;
    }
    /// After mark_used() of every page that this frame needs: the others are queued to be given
    /// away.
    /// @param in_view  by page: whether it was projected; empty: none
    void queue_unused(const std::vector<std::uint8_t>& in_view = {});

    /// Adds a record of this frame. False if there is no page for it.
    /// @param floats  layout(instance).floats() of them
    bool add(int instance, const float* floats);

    /// Of what tells of pages, beside them.
    std::uint64_t table_bytes() const noexcept { return m_pages.size() * sizeof(Page); }
    std::uint64_t records() const noexcept { return m_records; }
    std::uint64_t evicted() const noexcept { return m_evicted; }            ///< in this frame
    std::uint64_t bytes() const noexcept { return m_in_use * page_bytes; }  ///< of pages in use

private:
    int take_page();
    static constexpr int idle_share = 8, most_idle = 8;

    std::vector<RecordLayout> m_layouts;
    std::vector<int> m_objects;
    LargePages<float> m_memory;
    std::vector<Page> m_pages;
    int m_touched = 0;
    std::vector<int> m_free;   ///< pages below m_touched, the next one last
    std::deque<int> m_unused;  ///< pages that may be given away, the oldest first
    std::vector<int> m_open;   ///< by instance: page of this frame with room, or -1
    int m_frame = -1;
    std::uint64_t m_records = 0, m_evicted = 0, m_in_use = 0;
};

}  // namespace estara
