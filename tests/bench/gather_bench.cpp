/* The photon map against nanoflann: tree build and gathers, one million photons.
 *
 * Both are given the same points and the same queries in one run; each figure is the least of
 * several rounds, rounds of the two taking turns, so that what else the machine does cancels.
 * nanoflann answers a plain k-nearest query; ours are timed twice: the same plain query, and a
 * whole irradiance estimate (slab, normals, decoded powers).
 * SPDX-License-Identifier: Apache-2.0 */
#include <nanoflann.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic" /* compound literals in C headers */
extern "C" {
#include "base/mem.h"
#include "base/stats.h"
#include "photon/gather.h"
}
#pragma GCC diagnostic pop

namespace
{

struct Cloud {
    std::vector<float> at;
    size_t kdtree_get_point_count() const { return at.size() / 3; }
    float kdtree_get_pt(size_t i, size_t axis) const { return at[3 * i + axis]; }
    template <class Box> bool kdtree_get_bbox(Box &) const { return false; }
};

using Peer = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud,
                                                 3, size_t>;

/* Points on the six faces of a unit box. */
V3 box_point(Rng *rng, V3 *normal)
{
    int face = static_cast<int>(rng_u32(rng) % 6);
    double u = rng_double(rng), v = rng_double(rng), side = face & 1 ? 1 : 0;
    double sign = face & 1 ? 1 : -1;
    if (face / 2 == 0) {
        *normal = v3(-sign, 0, 0);
        return v3(side, u, v);
    }
    if (face / 2 == 1) {
        *normal = v3(0, -sign, 0);
        return v3(u, side, v);
    }
    *normal = v3(0, 0, -sign);
    return v3(u, v, side);
}

std::vector<Photon> make_photons(size_t count)
{
    std::vector<Photon> photons(count);
    for (size_t i = 0; i < count; i++) {
        Rng rng = rng_at(1, 0, i);
        V3 n, p = box_point(&rng, &n);
        Photon &photon = photons[i];
        photon = Photon{};
        photon.pos[0] = static_cast<float>(p.x);
        photon.pos[1] = static_cast<float>(p.y);
        photon.pos[2] = static_cast<float>(p.z);
        rgbe_encode(rgb(1, 0.5f, 0.25f), &rng, photon.rgbe);
        direction_encode(n, &photon.phi, &photon.theta);
        photon.flags = static_cast<uint16_t>(normal14_encode(n) << 2);
    }
    return photons;
}

PhotonMap *build(const std::vector<Photon> &photons, int threads, double *seconds)
{
    Diag diag;
    diag_init(&diag, nullptr, nullptr);
    Photon *copy = static_cast<Photon *>(mem_array(photons.size(), sizeof(Photon)));
    std::copy(photons.begin(), photons.end(), copy);
    PhotonMap *map = nullptr;
    double start = clock_wall();
    if (photon_map_new(&diag, copy, photons.size(), v3(0, 0, 0), threads, &map) != OK)
        std::exit(3);
    *seconds = clock_wall() - start;
    diag_done(&diag);
    return map;
}

void bench_build(const Cloud &cloud, const std::vector<Photon> &photons, int rounds)
{
    double peer = 1e9, one = 1e9, two = 1e9, seconds;
    for (int i = 0; i < rounds; i++) {
        double start = clock_wall();
        Peer tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
        tree.buildIndex();
        peer = std::min(peer, clock_wall() - start);
        photon_map_free(build(photons, 1, &seconds));
        one = std::min(one, seconds);
        photon_map_free(build(photons, 2, &seconds));
        two = std::min(two, seconds);
    }
    std::printf("tree build, %zu photons\n", photons.size());
    std::printf("  %-34s %9.1f ms\n", "nanoflann", peer * 1e3);
    std::printf("  %-34s %9.1f ms   %5.2f times faster (reach 1.2)\n", "pms, 1 thread", one * 1e3,
                peer / one);
    std::printf("  %-34s %9.1f ms   %5.2f times faster (reach 2.0)\n", "pms, 2 threads", two * 1e3,
                peer / two);
}

/* A screen of side x side queries across one face, row by row. */
std::vector<V3> screen_queries(int side)
{
    std::vector<V3> queries;
    for (int y = 0; y < side; y++)
        for (int x = 0; x < side; x++)
            queries.push_back(v3((x + 0.5) / side, (y + 0.5) / side, 0));
    return queries;
}

double time_peer(const Peer &tree, const std::vector<V3> &queries, size_t k, double *sum)
{
    std::vector<size_t> index(k);
    std::vector<float> distance2(k);
    *sum = 0;
    double start = clock_cpu();
    for (const V3 &q : queries) {
        float at[3] = {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z)};
        tree.knnSearch(at, k, index.data(), distance2.data());
        *sum += static_cast<double>(distance2[k - 1]);
    }
    return clock_cpu() - start;
}

double time_nearest(const PhotonMap *map, const std::vector<V3> &queries, int k,
                    GatherScratch *scratch, double *sum)
{
    GatherLimits limits{};
    limits.max_photons = k;
    limits.max_radius = INFINITY;
    limits.shape = GATHER_SPHERE;
    limits.normal_cosine = -1;
    *sum = 0;
    double start = clock_cpu();
    for (const V3 &q : queries) {
        const uint32_t *index;
        double radius2;
        photon_nearest(map, q, v3(0, 0, 1), &limits, scratch, &index, &radius2);
        *sum += radius2;
    }
    return clock_cpu() - start;
}

double time_gather(const PhotonMap *map, const std::vector<V3> &queries, int k, double radius,
                   GatherScratch *scratch, double *used)
{
    GatherLimits limits{};
    limits.max_photons = k;
    limits.max_radius = radius;
    limits.shape = GATHER_DISK;
    limits.normal_cosine = 0.5;
    *used = 0;
    double start = clock_cpu();
    for (const V3 &q : queries) {
        Rgb out;
        *used += photon_gather(map, q, v3(0, 0, 1), &limits, scratch, &out);
    }
    return clock_cpu() - start;
}

void bench_gather(const Peer &tree, const PhotonMap *map, const std::vector<V3> &queries, int k,
                  int rounds)
{
    GatherScratch *scratch = gather_scratch_new();
    double peer = 1e9, nearest = 1e9, gather = 1e9, fixed = 1e9;
    double peer_sum = 0, our_sum = 0, used = 0;
    double face_density = static_cast<double>(photon_map_count(map)) / 6;
    double radius = std::sqrt(k / (PMS_PI * face_density));
    for (int i = 0; i < rounds; i++) {
        peer = std::min(peer, time_peer(tree, queries, static_cast<size_t>(k), &peer_sum));
        nearest = std::min(nearest, time_nearest(map, queries, k, scratch, &our_sum));
        gather = std::min(gather, time_gather(map, queries, k, INFINITY, scratch, &used));
        fixed = std::min(fixed, time_gather(map, queries, 0, radius, scratch, &used));
    }
    double us = 1e6 / static_cast<double>(queries.size());
    std::printf("  %5d %9.2f %9.2f %7.2f %9.2f %7.2f %9.2f %9s\n", k, peer * us, nearest * us,
                peer / nearest, gather * us, peer / gather, fixed * us,
                std::fabs(peer_sum - our_sum) <= 1e-5 * peer_sum ? "same" : "DIFFERENT");
    gather_scratch_free(scratch);
}

} // namespace

int main()
{
    const size_t count = 1000000;
    std::vector<Photon> photons = make_photons(count);
    Cloud cloud;
    for (const Photon &photon : photons)
        cloud.at.insert(cloud.at.end(), photon.pos, photon.pos + 3);
    bench_build(cloud, photons, 5);
    Peer tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
    tree.buildIndex();
    double seconds;
    PhotonMap *map = build(photons, 1, &seconds);
    std::printf("map memory: %.3f bytes a photon (reach 20.4)\n",
                static_cast<double>(photon_map_bytes(map)) / static_cast<double>(count));
    std::printf("gather, microseconds a query, screen order, 1 thread (reach 2.5 times at 100)\n");
    std::printf("  %5s %9s %9s %7s %9s %7s %9s %9s\n", "k", "nanoflann", "k nearest", "times",
                "estimate", "times", "in radius", "radii");
    std::vector<V3> queries = screen_queries(150);
    for (int k : {8, 50, 100, 200, 500})
        bench_gather(tree, map, queries, k, k > 200 ? 3 : 5);
    photon_map_free(map);
    return 0;
}
