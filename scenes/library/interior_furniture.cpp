// What stands in the room of the scene `interior`.
#include <array>
#include <cmath>

#include "interior_room.h"

namespace estara::examples::interior_room {

namespace {

/// A turned leg from the floor up to `tall`, laid along x.
Mesh leg(double tall, double thick) {
    const dvec2 profile[]{{0, 0},
                          {0.55 * thick, 0},
                          {0.62 * thick, 0.01},
                          {0.5 * thick, 0.12 * tall},
                          {0.75 * thick, 0.22 * tall},
                          {0.6 * thick, 0.3 * tall},
                          {0.95 * thick, 0.6 * tall},
                          {0.6 * thick, 0.72 * tall},
                          {1.1 * thick, 0.76 * tall},
                          {0.7 * thick, 0.8 * tall},
                          {thick, 0.85 * tall},
                          {thick, tall},
                          {thick, tall},
                          {0, tall}};
    return laid(lathe(profile, {48, 90}));
}

}  // namespace

void add_armchair(Room& room, const std::string& name, const Material& cloth,
                  const Material& pillow, const vec3& place, float facing) {
    const quat turn = turned(facing);
    const auto at = [&](const vec3& p) { return place + turn * p; };
    const std::vector<Mesh> body{
        moved(rounded_box({0.36, 0.12, 0.37}, 0.05, 6, 6), {0, 0.27f, 0.0f}),
        moved(superellipsoid({0.315, 0.105, 0.37}, 0.3, 0.35, {120, 60}), {0, 0.425f, 0.05f}),
        moved(rounded_box({0.36, 0.40, 0.10}, 0.095, 8, 12), {0, 0.60f, -0.33f},
              turned(-11, x_axis)),
        moved(rounded_box({0.095, 0.20, 0.40}, 0.09, 8, 12), {-0.395f, 0.385f, 0.0f}),
        moved(rounded_box({0.095, 0.20, 0.40}, 0.09, 8, 12), {0.395f, 0.385f, 0.0f}),
    };
    room.put(name, cloth, body, place, turn);
    room.put(name + " cushion", pillow, superellipsoid({0.22, 0.075, 0.22}, 0.75, 0.45, {100, 50}),
             at({0.03f, 0.70f, -0.155f}), turn * turned(12, z_axis) * turned(69, x_axis));
    const Room::Model foot =
        room.model(name + " foot", walnut, leg(0.17, 0.028), 3.0f, {0, 0.1f, 0});
    for (const float x : {-0.36f, 0.36f})
        for (const float z : {-0.30f, 0.32f})
            room.stand(name + " foot", foot, at({x, 0, z}), upright);
}

void add_coffee_table(Room& room, const vec3& place) {
    const dvec2 top[]{{0, 0},         {0.45, 0},    {0.5, 0},      {0.515, 0.012},
                      {0.515, 0.022}, {0.5, 0.034}, {0.45, 0.034}, {0, 0.034}};
    constexpr float high = 0.40f, surface = high + 0.034f;
    room.put("coffee table top", green_marble, lathe(top, {160, 50}), place + vec3(0, high, 0),
             as_is, 5.0f);
    const dvec2 apron[]{{0.34, 0},    {0.35, 0},    {0.36, 0},    {0.36, 0.01},
                        {0.36, 0.06}, {0.36, 0.07}, {0.35, 0.07}, {0.34, 0.07},
                        {0.34, 0.06}, {0.34, 0.01}, {0.34, 0}};
    room.put("coffee table apron", walnut, lathe(apron, {96, 24}),
             place + vec3(0, high - 0.069f, 0), as_is, 2.0f, {0, 0.3f, 0});
    const Room::Model legs =
        room.model("coffee table leg", walnut, leg(high + 0.001, 0.03), 3.0f, {0, 0.08f, 0});
    for (int i = 0; i < 4; ++i)
        room.stand("coffee table leg", legs,
                   place + turned(45.0f + 90.0f * float(i)) * vec3(0.34f, 0, 0), upright);

    // The tea things.
    const dvec2 body[]{{0, 0},         {0.09, 0},      {0.10, 0.0},    {0.115, 0.02},
                       {0.118, 0.07},  {0.095, 0.125}, {0.062, 0.15},  {0.06, 0.153},
                       {0.064, 0.157}, {0.06, 0.162},  {0.03, 0.175},  {0.012, 0.18},
                       {0.010, 0.188}, {0.018, 0.197}, {0.016, 0.206}, {0, 0.209}};
    const auto spout = [](double s) {
        return dvec2(0.085 + 0.10 * s + 0.012 * std::sin(2 * pi * s),
                     0.055 + 0.105 * s * s + 0.01 * s);
    };
    const auto bail = [](double s) {
        return dvec2(0.085 * std::cos(pi * (1.0 - s)), 0.125 + 0.14 * std::sin(pi * s));
    };
    const std::vector<Mesh> kettle{
        lathe(body, {120, 130}),
        planar_tube(spout, [](double s) { return 0.026 - 0.014 * s; }, {40, 40}),
        planar_tube(bail, [](double) { return 0.007; }, {24, 80})};
    room.put("kettle", blue_enamel, kettle, place + vec3(-0.02f, surface, -0.02f), turned(-35));
    const dvec2 cup[]{{0, 0},        {0.024, 0},    {0.027, 0.0},  {0.027, 0.005},
                      {0.036, 0.02}, {0.041, 0.05}, {0.043, 0.07}, {0.042, 0.072},
                      {0.040, 0.07}, {0.037, 0.05}, {0.03, 0.018}, {0, 0.012}};
    const auto ear = [](double s) {
        return dvec2(0.036 + 0.024 * std::sin(pi * s), 0.018 + 0.038 * s);
    };
    const std::vector<Mesh> cups{lathe(cup, {72, 70}),
                                 planar_tube(ear, [](double) { return 0.0035; }, {16, 40})};
    const dvec2 saucer[]{{0, 0},         {0.03, 0},      {0.035, 0.002},
                         {0.068, 0.012}, {0.07, 0.014},  {0.068, 0.016},
                         {0.034, 0.006}, {0.03, 0.0045}, {0, 0.0045}};
    const Room::Model cup_model = room.model("cup", cream_enamel, joined(cups));
    const Room::Model saucer_model = room.model("saucer", cream_enamel, lathe(saucer, {72, 40}));
    const vec3 places[]{{0.26f, 0, 0.12f}, {-0.16f, 0, 0.26f}, {-0.27f, 0, -0.12f}};
    for (int i = 0; i < 3; ++i) {
        room.stand("saucer", saucer_model, place + vec3(0, surface, 0) + places[i]);
        room.stand("cup", cup_model, place + vec3(0, surface + 0.0052f, 0) + places[i],
                   turned(70.0f + 100.0f * float(i)));
    }
    const dvec2 bowl[]{{0, 0},        {0.04, 0},     {0.045, 0},    {0.045, 0.008},
                       {0.05, 0.015}, {0.1, 0.045},  {0.12, 0.075}, {0.118, 0.078},
                       {0.11, 0.072}, {0.09, 0.048}, {0.04, 0.022}, {0, 0.02}};
    room.put("bowl", warm_marble, lathe(bowl, {96, 80}), place + vec3(0.14f, surface, -0.26f),
             as_is, 5.0f);
}

/// A chair with turned legs and a back of slats, facing +z.
void add_chair(Room& room, const std::string& name, const vec3& place, float facing) {
    const quat turn = turned(facing);
    const auto at = [&](const vec3& p) { return place + turn * p; };
    const Room::Model front_leg =
        room.model(name + " leg", oak_dark, leg(0.45, 0.021), 2.5f, {0, 0.09f, 0.02f});
    for (const float x : {-0.18f, 0.18f})
        room.stand(name + " leg", front_leg, at({x, 0, 0.18f}), turn * upright);
    const Mesh post = laid(rounded_box({0.018, 0.50, 0.018}, 0.01, 4, 4));
    for (const float x : {-0.18f, 0.18f})
        room.put(name + " post", oak_dark, post, at({x, 0.495f, -0.21f}),
                 turn * turned(-6, x_axis) * upright, 2.5f, {x * 9.0f, 0.08f, 0});
    room.put(name + " seat", oak_dark, superellipsoid({0.225, 0.022, 0.225}, 0.35, 0.3, {120, 40}),
             at({0, 0.462f, 0}), turn, 2.0f, {0, 0.15f, 0});
    for (int i = 0; i < 3; ++i) {
        const float y = 0.62f + 0.14f * float(i);
        const double bow = 0.035;
        const auto slat = [&](double u, double v) {  // a bent board
            const double around = 2 * pi * u, s = 2 * v - 1;
            return dvec3(0.178 * s, 0.034 * std::sin(around),
                         -bow * (1 - s * s) + 0.009 * std::cos(around));
        };
        room.put(name + " slat " + std::to_string(i), oak_dark,
                 tessellate(slat, {40, 40}, {.u = true, .v = false}),
                 at({0, y, -0.21f - 0.105f * (y - 0.495f)}), turn, 2.5f, {float(i), 0.12f, 0});
    }
    const Mesh rung = laid(
        lathe(std::array{dvec2{0, -0.17}, dvec2{0.008, -0.17}, dvec2{0.01, -0.1}, dvec2{0.014, 0},
                         dvec2{0.01, 0.1}, dvec2{0.008, 0.17}, dvec2{0, 0.17}},
              {24, 30}));
    room.put(name + " rung", oak_dark, rung, at({0, 0.17f, 0.18f}), turn, 2.5f);
}

namespace {

/// A shade around a bulb, open above and below.
Mesh lamp_shade(double below, double above, double tall) {
    const dvec2 profile[]{{below - 0.002, 0},     {below, 0},
                          {below, 0.004},         {above, tall - 0.004},
                          {above, tall},          {above - 0.002, tall},
                          {above - 0.004, tall},  {above - 0.004, tall - 0.004},
                          {below - 0.004, 0.004}, {below - 0.004, 0},
                          {below - 0.002, 0}};
    return lathe(profile, {96, 40});
}

const Material linen = plastic_in("linen", {0.72, 0.62, 0.46});
const Material lit_shade = glowing("lit shade", {0.95, 0.68, 0.36}, 2.0);

}  // namespace

void add_lamps(Room& room, const vec3& floor_lamp, const vec3& table_lamp) {
    const dvec2 stand[]{{0, 0},        {0.14, 0},    {0.15, 0.004}, {0.13, 0.02}, {0.03, 0.035},
                        {0.014, 0.06}, {0.012, 0.2}, {0.012, 0.7},  {0.02, 0.72}, {0.012, 0.74},
                        {0.011, 0.9},  {0.010, 1.4}, {0.010, 1.46}, {0, 1.46}};
    room.put("floor lamp", brass, lathe(stand, {64, 120}), floor_lamp);
    room.put("floor lamp shade", lit_shade, lamp_shade(0.22, 0.13, 0.26),
             floor_lamp + vec3(0, 1.42f, 0));
    const dvec2 foot[]{{0, 0},         {0.07, 0},     {0.075, 0.004}, {0.06, 0.014},
                       {0.03, 0.03},   {0.05, 0.08},  {0.07, 0.14},   {0.045, 0.2},
                       {0.014, 0.235}, {0.012, 0.26}, {0.010, 0.3},   {0, 0.3}};
    room.put("table lamp", cream_enamel, lathe(foot, {80, 100}), table_lamp);
    room.put("table lamp shade", linen, lamp_shade(0.16, 0.09, 0.19),
             table_lamp + vec3(0, 0.28f, 0));
}

/// A dish above a bulb; @param bulb  its centre. The lamp itself is just below it.
void add_pendant(Room& room, const vec3& bulb) {
    const dvec2 dish[]{{0.010, 0.108}, {0.03, 0.105},   {0.05, 0.092},   {0.14, 0.058},
                       {0.22, 0.005},  {0.234, -0.004}, {0.238, -0.003}, {0.235, 0.0},
                       {0.22, 0.01},   {0.14, 0.065},   {0.05, 0.10},    {0.03, 0.118},
                       {0.010, 0.12}};
    room.put("pendant dish", glowing("lit brass", {0.85, 0.55, 0.22}, 1.3), lathe(dish, {120, 70}),
             bulb);
    const dvec2 rod[]{{0, 0.02},    {0.016, 0.02}, {0.018, 0.03}, {0.018, 0.12}, {0.006, 0.15},
                      {0.005, 0.2}, {0.005, 0.6},  {0.03, 0.74},  {0.05, 0.775}, {0, 0.779}};
    room.put("pendant rod", brass, lathe(rod, {40, 60}), bulb);
    room.put("pendant globe", lit_shade, sphere(0.032, {48, 32}), bulb);
}

void add_side_table(Room& room, const vec3& place) {
    const dvec2 column[]{{0, 0},       {0.18, 0},    {0.19, 0.006}, {0.17, 0.03},  {0.05, 0.05},
                         {0.025, 0.1}, {0.045, 0.2}, {0.028, 0.3},  {0.024, 0.45}, {0.04, 0.55},
                         {0.09, 0.57}, {0.1, 0.59},  {0, 0.59}};
    room.put("side table column", walnut, laid(lathe(column, {72, 110})), place, upright, 2.0f,
             {0, 0.06f, 0.02f});
    const dvec2 top[]{{0, 0},        {0.26, 0},    {0.30, 0},    {0.31, 0.008}, {0.305, 0.016},
                      {0.31, 0.024}, {0.30, 0.03}, {0.26, 0.03}, {0, 0.03}};
    room.put("side table top", walnut, lathe(top, {120, 44}), place + vec3(0, 0.588f, 0),
             turned(20), 1.6f, {0, 0.05f, 0.12f});
}

void add_bookcase(Room& room, float left, float right) {
    constexpr float tall = 2.05f, deep = 0.30f, board = 0.026f;
    const float z = back + 0.5f * deep + 0.004f, middle = 0.5f * (left + right),
                wide = right - left;
    const Mesh side = rounded_box({0.5 * tall, 0.5 * board, 0.5 * deep}, 0.004, 1, 2);
    for (const float x : {left, right})
        room.put("bookcase side", walnut, side, {x, 0.5f * tall, z}, upright, 1.2f,
                 {x, 0.2f, 0.1f});
    const Mesh shelf =
        rounded_box({0.5 * wide - 0.01, 0.5 * board, 0.5 * deep - 0.004}, 0.004, 1, 2);
    const float shelves[]{0.09f, 0.47f, 0.85f, 1.22f, 1.58f, tall - 0.02f};
    for (const float y : shelves)
        room.put("bookcase shelf", walnut, shelf, {middle, y, z}, as_is, 1.2f,
                 {3 * y, 0.25f, 0.1f});
    room.put("bookcase back", walnut, slab({double(wide), double(tall) - 0.03, 0.012}),
             {middle, 0.5f * tall, back + 0.008f}, as_is, 1.2f, {0, 0, 0.5f});
    room.put("bookcase cornice", walnut,
             rounded_box({0.5 * wide + 0.05, 0.03, 0.5 * deep + 0.03}, 0.02, 1, 5),
             {middle, tall + 0.02f, z + 0.014f}, as_is, 1.2f, {5, 0.2f, 0.1f});

    // Books of few formats in many places.
    const Material covers[]{plastic_in("leather brown", {0.20, 0.09, 0.045}, 0.35, 0.15, 0.2),
                            plastic_in("leather red", {0.30, 0.035, 0.03}, 0.35, 0.15, 0.2),
                            plastic_in("leather green", {0.04, 0.13, 0.065}, 0.35, 0.15, 0.2),
                            plastic_in("leather blue", {0.04, 0.07, 0.18}, 0.35, 0.15, 0.2),
                            plastic_in("vellum", {0.62, 0.54, 0.38}, 0.35, 0.1, 0.2),
                            plastic_in("leather black", {0.035, 0.03, 0.028}, 0.35, 0.2, 0.2)};
    std::vector<Room::Model> books;
    std::vector<dvec3> sizes;
    for (unsigned i = 0; i < 12; ++i) {
        sizes.emplace_back(0.022 + 0.028 * scatter(i + 31), 0.20 + 0.095 * scatter(i + 67),
                           0.15 + 0.05 * scatter(i + 91));
        books.push_back(room.model("book " + std::to_string(i), covers[i % std::size(covers)],
                                   rounded_box(0.5 * sizes.back(), 0.005, 1, 2)));
    }
    unsigned n = 0;
    for (std::size_t s = 0; s + 1 < std::size(shelves); ++s) {
        float x = left + 0.03f;
        while (true) {
            const auto kind = std::size_t(scatter(n * 7 + 1000) * float(books.size()));
            const dvec3 size = sizes[kind];
            const bool gap = scatter(n + 3000) < 0.06f;
            if (x + float(size.x) + (gap ? 0.12f : 0.0f) > right - 0.03f) break;
            if (gap) x += 0.12f;
            room.stand("book", books[kind],
                       {x + 0.5f * float(size.x), shelves[s] + 0.5f * board + 0.5f * float(size.y),
                        back + 0.04f + 0.5f * float(size.z) + 0.02f * scatter(n + 5000)});
            x += float(size.x) + 0.0015f;
            ++n;
        }
    }
}

void add_statue(Room& room, const vec3& place) {
    const std::vector<Mesh> pedestal{
        moved(rounded_box({0.20, 0.05, 0.20}, 0.012, 4, 4), {0, 0.05f, 0}),
        moved(rounded_box({0.155, 0.42, 0.155}, 0.01, 4, 4), {0, 0.50f, 0}),
        moved(rounded_box({0.19, 0.035, 0.19}, 0.014, 4, 4), {0, 0.945f, 0})};
    room.put("pedestal", granite, pedestal, place);
    room.put("knot", white_marble, torus_knot(2, 3, 0.16, 0.07, 0.045, {360, 44}),
             place + vec3(0, 1.255f, 0), turned(35) * turned(78, x_axis), 4.0f);
}

void add_floor_vase(Room& room, const vec3& place) {
    const dvec2 vase[]{{0, 0},        {0.10, 0},     {0.115, 0},     {0.115, 0.015}, {0.09, 0.04},
                       {0.12, 0.15},  {0.18, 0.33},  {0.185, 0.48},  {0.11, 0.64},   {0.065, 0.72},
                       {0.07, 0.77},  {0.105, 0.82}, {0.107, 0.828}, {0.098, 0.825}, {0.06, 0.77},
                       {0.055, 0.72}, {0.09, 0.64},  {0, 0.60}};
    room.put("floor vase", warm_marble, lathe(vase, {120, 150}), place, as_is, 2.0f, {0, 2, 0});
}

void add_rug(Room& room, const vec3& place) {
    room.put("rug border", rug_border, rounded_box({1.55, 0.008, 1.10}, 0.006, 12, 2),
             place + vec3(0, 0.008f, 0));
    room.put("rug field", rug_field, rounded_box({1.36, 0.010, 0.91}, 0.006, 12, 2),
             place + vec3(0, 0.011f, 0));
}

}  // namespace estara::examples::interior_room
