// What all tests of packets share: how far bounds are widened, and how hits are taken.
#ifndef HR_LIB_PACKET_HITS_H
#define HR_LIB_PACKET_HITS_H

#include "lib/packet_rays.h"
#include "lib/traverse.h"

// Blocks of one lane have no vectors to test: RayQueries traces their rays one by one.
#define HR_PACKETS (HR_EXPLICIT_VECTORS && HR_W > 1 && HR_L > 1)
#if HR_PACKETS

// The bounds of a whole packet are widened by 8 ulps on both sides: a reciprocal, a difference and a product of error.
#define HR_INTERVAL_NEAR 0.999999f
#define HR_INTERVAL_FAR 1.000001f

// Takes hits of one primitive into group k; ties go to the smaller primitive.
static inline bool take_hits(Packet* p, uint k, int16 met, float16 t, float16 u, float16 v, int primitive) {
  const int16 closer = met & (t > p->t_min) & ((int16)(primitive) != p->skip[k]) &
                       ((t < p->t[k]) | ((t == p->t[k]) & ((int16)(primitive) < p->primitive[k])));
  if (!any_lane16(closer)) return false;
  p->t[k] = select(p->t[k], t, closer);
  p->u[k] = select(p->u[k], u, closer);
  p->v[k] = select(p->v[k], v, closer);
  p->primitive[k] = select(p->primitive[k], (int16)(primitive), closer);
  return true;
}

#endif

#endif
