// The room of the scene `interior`: floor, walls, window and what lies outside, fireplace, door.
#include <array>
#include <cmath>

#include "interior_room.h"

namespace estara::examples::interior_room {

void add_floor(Room& room) {
    room.put("subfloor", iron,
             between({-half_width - 0.1f, -0.2f, back - 0.1f},
                     {half_width + 0.1f, -0.022f, front + 0.1f}),
             vec3(0));
    constexpr float width = 0.15f, gap = 0.0025f, length = 1.9f;
    // Boards cut from a few logs, each somewhere else.
    std::vector<Room::Model> boards;
    const Material* kinds[]{&oak,      &oak_dark, &oak,      &oak_pale, &oak,
                            &oak_dark, &oak,      &oak_pale, &oak,      &oak_dark};
    for (unsigned i = 0; i < std::size(kinds); ++i)
        boards.push_back(room.model(
            "board " + std::to_string(i), *kinds[i],
            rounded_box({0.5 * (length - gap), 0.011, 0.5 * (width - gap)}, 0.002, 1, 1), 0.5f,
            {3.0f * float(i), 0.22f + 0.2f * scatter(i), 0.5f * scatter(i + 50) - 0.25f}));
    unsigned n = 0;
    for (int row = 0; row < 46; ++row) {
        const float z = back + width * (float(row) + 0.5f);
        if (z > front) break;
        const float shift = length * scatter(unsigned(row) + 200);
        for (float x = -half_width - shift; x < half_width; x += length, ++n) {
            const auto kind = unsigned(scatter(n + 900) * float(boards.size()));
            room.stand("board", boards[kind], {x + 0.5f * length, -0.011f, z},
                       turned(scatter(n + 400) < 0.5f ? 0.0f : 180.0f));
        }
    }
}

void add_walls(Room& room) {
    const float w = half_width, t = 0.25f;
    room.put("left wall", plaster, between({-w - t, -0.1f, back}, {-w, height, front}), vec3(0));
    room.put("back wall", plaster, between({-w - t, -0.1f, back - t}, {w + t, height, back}),
             vec3(0));
    room.put("front wall", plaster, between({-w - t, -0.1f, front}, {w + t, height, front + t}),
             vec3(0));
    room.put("ceiling", ceiling_white,
             between({-w - t, height, back - t}, {w + t, height + t, front + t}), vec3(0));
    // Around the window.
    const std::vector<Mesh> parts{
        between({w, -0.1f, back}, {w + t, height, window_far}, 0.001),
        between({w, -0.1f, window_near}, {w + t, height, front}, 0.001),
        between({w, -0.1f, window_far}, {w + t, window_low, window_near}, 0.001),
        between({w, window_high, window_far}, {w + t, height, window_near}, 0.001)};
    room.put("window wall", sandstone, with_metric_uv(joined(parts)), vec3(0));
    // Skirting boards.
    const Mesh back_board = slab({2.0 * w, 0.11, 0.02});
    const Mesh side_board = slab({double(front - back), 0.11, 0.02});
    room.put("skirting back", walnut, back_board, {0, 0.055f, back + 0.01f}, as_is, 0.8f,
             {0, 0.1f, 0.3f});
    room.put("skirting left", walnut, side_board, {-w + 0.01f, 0.055f, 0.5f * (front + back)},
             turned(90), 0.8f, {9, 0.1f, 0.3f});
    room.put("skirting right", walnut, side_board, {w - 0.01f, 0.055f, 0.5f * (front + back)},
             turned(-90), 0.8f, {5, 0.1f, 0.3f});
    // Beams under the ceiling.
    const Mesh beam = rounded_box({w, 0.11, 0.09}, 0.015, 1, 3);
    for (int i = 0; i < 5; ++i)
        room.put("beam " + std::to_string(i), beam_oak, beam,
                 {0, height - 0.09f, back + 0.7f + 1.35f * float(i)}, as_is, 0.8f,
                 {7.0f * float(i), 0.05f, 0.03f});
}

void add_window(Room& room) {
    const float x = half_width + 0.13f, middle = 0.5f * (window_near + window_far);
    const float wide = window_near - window_far, tall = window_high - window_low;
    const float centre_y = 0.5f * (window_low + window_high);
    const auto bar = [&](const std::string& name, float length, float thick, const vec3& place,
                         const quat& turn) {
        room.put(name, walnut, rounded_box({0.5 * length, 0.5 * thick, 0.5 * thick}, 0.008, 1, 3),
                 place, turn, 0.8f, place + vec3(0, 0.2f, 0));
    };
    for (const float side : {-1.0f, 1.0f}) {
        bar("window post", tall, 0.075f, {x, centre_y, middle + side * (0.5f * wide - 0.035f)},
            upright);
        bar("window rail", wide, 0.07f, {x, centre_y + side * (0.5f * tall - 0.034f), middle},
            turned(90));
    }
    bar("window mullion", tall - 0.02f, 0.055f, {x, centre_y, middle}, upright);
    bar("window transom", wide - 0.02f, 0.05f, {x, centre_y + 0.28f, middle}, turned(90));
    for (const float side : {-1.0f, 1.0f})
        bar("window bar", wide - 0.02f, 0.026f,
            {x, centre_y + 0.28f * (side > 0 ? -0.9f : -2.0f) + 0.28f * 0.4f, middle}, turned(90));
    room.put("sill", granite, rounded_box({0.19, 0.028, 0.5 * wide + 0.06}, 0.012, 1, 4),
             {half_width + 0.03f, window_low + 0.02f, middle}, as_is);

    // Curtains in folds, held back by a band.
    const auto curtain = [](double u, double v) {
        const double s = 0.5 - 0.5 * std::cos(2 * pi * u), off = -0.010 * std::sin(2 * pi * u);
        const double held = std::exp(-std::pow((v - 0.40) / 0.17, 2.0));
        const double width = 0.62 * (1.0 - 0.45 * held);
        const double phase =
            2 * pi * 6.0 * s + 0.9 * std::sin(2 * pi * s) + 0.5 * std::sin(3.0 * v);
        const double deep = (0.050 + 0.02 * std::sin(5.0 * s + 2.0 * v)) * (1.0 - 0.25 * held);
        return dvec3(width * (s - 0.5), 2.42 * v,
                     deep * std::sin(phase) + off * (1.0 + 0.5 * held));
    };
    const Room::Model cloth = room.model("curtain", wine_velvet,
                                         tessellate(curtain, {560, 110}, {.u = true, .v = false}));
    for (const float z : {window_near + 0.16f, window_far - 0.16f})
        room.stand("curtain", cloth, {half_width - 0.17f, 0.03f, z},
                   turned(z > middle ? -90.0f : 90.0f));
    room.put("curtain rod", brass,
             laid(lathe(std::array{dvec2{0, -1.55}, dvec2{0.035, -1.55}, dvec2{0.03, -1.47},
                                   dvec2{0.014, -1.46}, dvec2{0.014, -1.4}, dvec2{0.014, 0},
                                   dvec2{0.014, 1.4}, dvec2{0.014, 1.46}, dvec2{0.03, 1.47},
                                   dvec2{0.035, 1.55}, dvec2{0, 1.55}},
                        {24, 60})),
             {half_width - 0.17f, 2.49f, middle}, turned(90));
}

void add_courtyard(Room& room) {
    room.put("court", court_stone,
             with_metric_uv(between({half_width + 0.26f, -0.6f, -16}, {16, -0.3f, 12})), vec3(0));
    room.put("court wall", court_sandstone,
             with_metric_uv(between({10.0f, -0.35f, -16}, {10.4f, 1.55f, 12})), vec3(0));
    room.put("court coping", granite, rounded_box({0.28, 0.05, 13.9}, 0.02, 1, 3),
             {10.2f, 1.6f, -2});
    const Mesh ball = sphere(0.62, {90, 60}),
               cone = superellipsoid({0.55, 1.5, 0.55}, 1.3, 1.0, {90, 80});
    const dvec2 pot[]{{0, 0},       {0.24, 0},    {0.27, 0.02}, {0.33, 0.3}, {0.40, 0.5},
                      {0.40, 0.56}, {0.36, 0.56}, {0.34, 0.5},  {0, 0.48}};
    const Room::Model pots = room.model("tree pot", warm_marble, lathe(pot, {60, 40}), 1.0f);
    for (int i = 0; i < 5; ++i) {
        const vec3 place(7.4f + 0.4f * float(i % 2), -0.3f, -6.8f + 2.1f * float(i));
        room.stand("tree pot", pots, place);
        room.put("tree " + std::to_string(i), foliage, i % 2 ? cone : ball,
                 place + vec3(0, i % 2 ? 1.9f : 1.05f, 0));
    }
    const auto sky = [](double u, double v) {
        const double angle = (80 - 160 * u) * double(degree);
        return dvec3(3.0 + 22.0 * std::cos(angle), -1.0 + 9.5 * v, -2.0 + 22.0 * std::sin(angle));
    };
    room.put("sky", glowing("sky", {0.50, 0.70, 0.98}, 2.2),
             tessellate(sky, {60, 8}, {.u = false, .v = false}), vec3(0));
}

void add_fireplace(Room& room) {
    const float left = fire_x - 1.0f, right = fire_x + 1.0f, z = breast_front;
    constexpr float half_opening = 0.46f, opening_high = 0.80f;
    const std::vector<Mesh> breast{
        between({left, 0, back - 0.01f}, {fire_x - half_opening, height, z}, 0.001),
        between({fire_x + half_opening, 0, back - 0.01f}, {right, height, z}, 0.001),
        between({fire_x - half_opening, opening_high, back - 0.01f},
                {fire_x + half_opening, height, z}, 0.001)};
    room.put("chimney", brick, with_metric_uv(joined(breast)), vec3(0));
    room.put("fireback", iron, rounded_box({half_opening + 0.02, 0.4, 0.01}, 0.005, 1, 2),
             {fire_x, 0.40f, back + 0.02f});
    room.put("hearth", hearth_stone,
             with_metric_uv(between({left - 0.1f, -0.01f, back + 0.03f},
                                    {right + 0.1f, 0.055f, z + 0.55f}, 0.012)),
             vec3(0));

    // The mantelpiece: two columns on plinths, a frieze and a shelf.
    const float y0 = 0.055f, zc = z + 0.12f;
    const dvec2 shaft[]{{0, 0},         {0.095, 0},    {0.10, 0.0},    {0.10, 0.03}, {0.075, 0.045},
                        {0.085, 0.065}, {0.07, 0.085}, {0.066, 0.1},   {0.069, 0.3}, {0.066, 0.55},
                        {0.058, 0.72},  {0.058, 0.74}, {0.072, 0.755}, {0.06, 0.77}, {0.065, 0.79},
                        {0.095, 0.82},  {0.10, 0.83},  {0.10, 0.85},   {0, 0.85}};
    const Room::Model column =
        room.model("mantel column", white_marble, lathe(shaft, {96, 130}), 3.0f, {0, 4, 0});
    const Room::Model plinth =
        room.model("mantel plinth", white_marble, rounded_box({0.125, 0.06, 0.115}, 0.008, 1, 3),
                   3.0f, {2, 0, 0});
    for (const float side : {-1.0f, 1.0f}) {
        const float x = fire_x + side * 0.64f;
        room.stand("mantel plinth", plinth, {x, y0 + 0.06f, zc});
        room.stand("mantel column", column, {x, y0 + 0.12f, zc});
    }
    room.put("mantel frieze", white_marble, rounded_box({0.80, 0.085, 0.115}, 0.008, 4, 3),
             {fire_x, y0 + 1.055f, zc}, as_is, 3.0f);
    room.put("mantel shelf", white_marble, rounded_box({0.92, 0.03, 0.17}, 0.02, 4, 6),
             {fire_x, y0 + 1.17f, zc + 0.03f}, as_is, 3.0f, {0, 1, 0});
    const std::vector<Mesh> jambs{
        between({-half_opening - 0.10f, 0, -0.02f}, {-half_opening + 0.005f, 0.93f, 0.02f}),
        between({half_opening - 0.005f, 0, -0.02f}, {half_opening + 0.10f, 0.93f, 0.02f}),
        between({-half_opening - 0.09f, opening_high - 0.005f, -0.018f},
                {half_opening + 0.09f, 0.94f, 0.018f})};
    room.put("fire surround", green_marble, jambs, {fire_x, y0, z + 0.022f}, as_is, 6.0f);

    // The fire: logs on irons, flames that give their own light.
    const Mesh log = laid(lathe(std::array{dvec2{0, -0.27}, dvec2{0.05, -0.27}, dvec2{0.055, -0.27},
                                           dvec2{0.055, -0.24}, dvec2{0.05, 0}, dvec2{0.056, 0.24},
                                           dvec2{0.055, 0.27}, dvec2{0.05, 0.27}, dvec2{0, 0.27}},
                                {48, 40}));
    room.put("log left", beam_oak, log, {fire_x - 0.05f, 0.125f, back + 0.22f}, turned(8), 3.0f);
    room.put("log right", beam_oak, log, {fire_x + 0.03f, 0.12f, back + 0.35f}, turned(-7), 3.0f);
    room.put("log top", beam_oak, log, {fire_x, 0.215f, back + 0.28f}, turned(24), 3.0f);
    const dvec2 flame[]{{0, 0},        {0.05, 0.0},  {0.075, 0.06}, {0.06, 0.15},
                        {0.025, 0.25}, {0.01, 0.32}, {0, 0.36}};
    const Mesh tongue = lathe(flame, {40, 50});
    const Material flames[]{glowing("flame", {1.0, 0.42, 0.05}, 2.6),
                            glowing("outer flame", {1.0, 0.2, 0.015}, 2.6)};
    for (int i = 0; i < 5; ++i) {
        const float size = 0.6f + 0.5f * scatter(unsigned(i) + 7);
        room.put(
            "flame " + std::to_string(i), flames[i % 2], scaled(tongue, size),
            {fire_x - 0.22f + 0.11f * float(i), 0.20f, back + 0.24f + 0.05f * scatter(unsigned(i))},
            turned(10.0f * (scatter(unsigned(i) + 3) - 0.5f), z_axis));
    }
    const Room::Model iron_bar =
        room.model("fire iron", iron, rounded_box({0.012, 0.012, 0.16}, 0.006, 1, 2));
    for (const float side : {-1.0f, 1.0f})
        room.stand("fire iron", iron_bar, {fire_x + side * 0.16f, 0.066f, back + 0.28f});

    // On the shelf, and the picture above it.
    const float shelf = y0 + 1.2f;
    const dvec2 urn[]{{0, 0},        {0.05, 0},     {0.055, 0},    {0.055, 0.012}, {0.022, 0.03},
                      {0.03, 0.06},  {0.085, 0.12}, {0.095, 0.19}, {0.06, 0.25},   {0.035, 0.28},
                      {0.06, 0.315}, {0.058, 0.32}, {0.03, 0.285}, {0, 0.27}};
    const Room::Model urns = room.model("urn", warm_marble, lathe(urn, {90, 110}), 4.0f);
    for (const float side : {-1.0f, 1.0f})
        room.stand("urn", urns, {fire_x + side * 0.72f, shelf, zc + 0.02f});
    const dvec2 stick[]{{0, 0},        {0.05, 0},      {0.053, 0.003}, {0.045, 0.015},
                        {0.012, 0.03}, {0.014, 0.08},  {0.009, 0.13},  {0.02, 0.17},
                        {0.022, 0.18}, {0.012, 0.182}, {0.011, 0.18},  {0, 0.18}};
    const dvec2 candle[]{{0, 0.17},    {0.011, 0.17}, {0.011, 0.18},
                         {0.011, 0.3}, {0.010, 0.36}, {0, 0.36}};
    const Room::Model sticks = room.model("candlestick", brass, lathe(stick, {48, 80}));
    const Room::Model candles = room.model(
        "candle", plastic_in("wax", {0.86, 0.80, 0.66}, 0.6, 0.2), lathe(candle, {32, 24}));
    for (const float x : {-0.44f, -0.30f, 0.36f}) {
        room.stand("candlestick", sticks, {fire_x + x, shelf, zc + 0.03f});
        room.stand("candle", candles, {fire_x + x, shelf, zc + 0.03f});
    }
    const auto frame_bar = [&](const std::string& name, float length, float thick,
                               const vec3& place, const quat& turn) {
        room.put(name, walnut, rounded_box({0.5 * length, 0.5 * thick, 0.02}, 0.012, 1, 4), place,
                 turn, 2.0f, place);
    };
    const vec3 picture(fire_x, 1.93f, z + 0.022f);
    frame_bar("picture frame top", 1.02f, 0.06f, picture + vec3(0, 0.35f, 0), as_is);
    frame_bar("picture frame bottom", 1.02f, 0.06f, picture - vec3(0, 0.35f, 0), as_is);
    frame_bar("picture frame left", 0.76f, 0.064f, picture - vec3(0.48f, 0, -0.001f), upright);
    frame_bar("picture frame right", 0.76f, 0.064f, picture + vec3(0.48f, 0, 0.001f), upright);
    room.put("picture", warm_marble, slab({0.94, 0.68, 0.012}), picture - vec3(0, 0, 0.008f), as_is,
             2.5f, {0, 3, 0});
}

void add_door(Room& room, float middle) {
    constexpr float wide = 0.88f, tall = 2.04f, post = 0.10f;
    const float z = back + 0.02f;
    const Mesh leaf = rounded_box({0.5 * tall, 0.5 * wide, 0.02}, 0.004, 1, 2);
    room.put("door leaf", oak, leaf, {middle, 0.5f * tall + 0.008f, z}, upright, 1.0f,
             {0, 0.1f, 0.35f});
    const Mesh panel = rounded_box({0.34, 0.155, 0.016}, 0.012, 1, 4);
    for (const float x : {-0.2f, 0.2f})
        for (const float y : {0.52f, 1.45f})
            room.put("door panel", oak, panel, {middle + x, y, z + 0.018f}, upright, 1.0f,
                     {4.0f * x + y, 0.1f, 0.35f});
    const Mesh jamb = rounded_box({0.5 * (tall + 0.07), 0.5 * post, 0.035}, 0.012, 1, 4);
    for (const float side : {-1.0f, 1.0f})
        room.put("door jamb", walnut, jamb,
                 {middle + side * (0.5f * wide + 0.45f * post), 0.5f * (tall + 0.07f), z + 0.006f},
                 upright, 1.0f, {2.0f * side, 0.2f, 0.1f});
    room.put("door lintel", walnut,
             rounded_box({0.5 * wide + post + 0.04, 0.06, 0.045}, 0.014, 1, 4),
             {middle, tall + 0.105f, z + 0.008f}, as_is, 1.0f, {4, 0.2f, 0.1f});
    room.put("door knob", brass, sphere(0.028, {48, 32}), {middle - 0.38f, 1.02f, z + 0.065f});
    const dvec2 rose[]{{0, 0},         {0.03, 0},     {0.032, 0.004}, {0.012, 0.008},
                       {0.009, 0.015}, {0.009, 0.05}, {0, 0.05}};
    room.put("door rose", brass, lathe(rose, {40, 40}), {middle - 0.38f, 1.02f, z + 0.018f},
             turned(90, x_axis));
}

}  // namespace estara::examples::interior_room
