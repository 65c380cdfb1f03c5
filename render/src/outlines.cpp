#include "outlines.h"

#include <algorithm>

#include "estara/shaders/wide.h"

namespace estara {

void OutlineFinder::start(int width) {
    const auto cells = std::size_t(width + 2);
    m_width = width;
    for (Row& row : m_rows) {
        row.instance.assign(cells, beyond);
        for (auto* planes : {&row.P, &row.Ng}) {
            for (std::vector<float>& plane : *planes) plane.resize(cells);
        }
        row.right.assign(cells, 0);
        row.below.assign(cells, 0);
    }
    std::fill_n(m_rows[m_now].instance.begin() + 1, width, none);
    m_first = true;
}

void OutlineFinder::next(std::uint8_t* above) {
    Row &now = m_rows[m_now], &before = m_rows[(m_now + 2) % 3], &rest = m_rows[(m_now + 1) % 3];
    struct View {
        const std::int32_t* instance;
        const float *Px, *Py, *Pz, *Nx, *Ny, *Nz;
        explicit View(const Row& row)
            : instance(row.instance.data()),
              Px(row.P[0].data()),
              Py(row.P[1].data()),
              Pz(row.P[2].data()),
              Nx(row.Ng[0].data()),
              Ny(row.Ng[1].data()),
              Nz(row.Ng[2].data()) {}
    };
    wide([a = View(now), b = View(before), right = now.right.data(), below = before.below.data(),
          cells = m_width + 1]() ESTARA_LOOP {
        const auto differ = [](const View& p, int x, const View& q, int y) ESTARA_LOOP {
            const int i = p.instance[x], j = q.instance[y];
            const bool alike =
                (i == j) & is_one_surface({p.Px[x], p.Py[x], p.Pz[x]}, {p.Nx[x], p.Ny[x], p.Nz[x]},
                                          {q.Px[y], q.Py[y], q.Pz[y]}, {q.Nx[y], q.Ny[y], q.Nz[y]});
            return alike | (i == beyond) | (j == beyond) ? 0 : 1;
        };
#pragma GCC ivdep
        for (int i = 0; i < cells; ++i) {
            right[i] = differ(a, i, a, i + 1);
            below[i] = differ(b, i, a, i);
        }
    });
    if (!m_first) tell(before, rest, above);
    m_first = false;
    m_now = (m_now + 1) % 3;
    std::fill_n(m_rows[m_now].instance.begin() + 1, m_width, none);
}

void OutlineFinder::finish(std::uint8_t* last) {
    Row& row = m_rows[(m_now + 2) % 3];
    std::fill(row.below.begin(), row.below.end(), 0);
    tell(row, m_rows[(m_now + 1) % 3], last);
}

/// @param above  the row before it, of which `below` is read; all 0 before the first
void OutlineFinder::tell(const Row& row, const Row& above, std::uint8_t* outline) const {
    for (std::size_t x = 1; x <= std::size_t(m_width); ++x) {
        outline[x - 1] =
            (row.right[x] | row.right[x - 1] | row.below[x] | above.below[x]) != 0 ? 1 : 0;
    }
}

}  // namespace estara
