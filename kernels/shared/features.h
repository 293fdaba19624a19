// The effect mask: one bit for each thing a scene may call for. The host computes it (host/scene/features.cpp) and
// passes it as -D HR_FEATURES=...; code tests it with HR_HAS(NAME), so that what is off still parses but is never
// compiled in. HR_IF_NAME(x) removes kernel parameters, path-state fields and whole stages.
#ifndef HR_SHARED_FEATURES_H
#define HR_SHARED_FEATURES_H

#define HR_FEATURE_ALWAYS 0u /* in the lists of this folder: needed whatever the mask */
#define HR_FEATURE_TRIANGLES (1u << 0)
#define HR_FEATURE_SPHERES (1u << 1)
#define HR_FEATURE_PLANES (1u << 2)
#define HR_FEATURE_SMOOTH_NORMALS (1u << 3)
#define HR_FEATURE_TEXTURES (1u << 4)
#define HR_FEATURE_NORMAL_MAPS (1u << 5)
#define HR_FEATURE_VERTEX_COLORS (1u << 6)
#define HR_FEATURE_METALLIC_ROUGHNESS (1u << 7)
#define HR_FEATURE_SPECULAR (1u << 8)
#define HR_FEATURE_AMBIENT (1u << 9)
#define HR_FEATURE_EMISSION (1u << 10)
#define HR_FEATURE_LIGHTS (1u << 11) /* any light, hence shadow rays */
#define HR_FEATURE_POINT_LIGHTS (1u << 12)
#define HR_FEATURE_DIRECTIONAL_LIGHTS (1u << 13)
#define HR_FEATURE_SPOT_LIGHTS (1u << 14)
#define HR_FEATURE_AREA_LIGHTS (1u << 15)
#define HR_FEATURE_EMITTERS (1u << 16)
#define HR_FEATURE_SECONDARY (1u << 17) /* reflection or refraction */
#define HR_FEATURE_REFLECTION (1u << 18)
#define HR_FEATURE_REFRACTION (1u << 19)
#define HR_FEATURE_BRANCHING (1u << 20) /* a surface both reflects and refracts: pending branches are stacked */
#define HR_FEATURE_FRESNEL (1u << 21)
#define HR_FEATURE_ORTHOGRAPHIC (1u << 22)
#define HR_FEATURE_PHONG_SHADING (1u << 23)
#define HR_FEATURE_INSTANCES (1u << 24)      /* meshes that copies share, each with a tree of its own */
#define HR_FEATURE_SHAPES (1u << 25)         /* disks, cylinders, cones, quadrics */
#define HR_FEATURE_IMPLICITS (1u << 26)      /* shapes that are implicit polynomial surfaces */
#define HR_FEATURE_THIN_TRIANGLES (1u << 27) /* many, whose distance edge functions tell badly */
#define HR_FEATURE_RADIOSITY (1u << 28)      /* patches, lit by a radiosity solution */
#define HR_FEATURE_GATHER (1u << 29)         /* these patches looked at with rays of their own: a final gather */
#define HR_FEATURE_COUNT 30

#ifndef __cplusplus

#ifndef HR_FEATURES
#define HR_FEATURES 0x3fffffffu
#endif

#define HR_HAS(feature) ((HR_FEATURES & HR_FEATURE_##feature) != 0)
#define HR_COMMA ,
#define HR_IF_ALWAYS(x) x

#if HR_HAS(TRIANGLES)
#define HR_IF_TRIANGLES(x) x
#else
#define HR_IF_TRIANGLES(x)
#endif
#if HR_HAS(SPHERES)
#define HR_IF_SPHERES(x) x
#else
#define HR_IF_SPHERES(x)
#endif
#if HR_HAS(PLANES)
#define HR_IF_PLANES(x) x
#else
#define HR_IF_PLANES(x)
#endif
#if HR_HAS(SMOOTH_NORMALS)
#define HR_IF_SMOOTH_NORMALS(x) x
#else
#define HR_IF_SMOOTH_NORMALS(x)
#endif
#if HR_HAS(TEXTURES)
#define HR_IF_TEXTURES(x) x
#else
#define HR_IF_TEXTURES(x)
#endif
#if HR_HAS(VERTEX_COLORS)
#define HR_IF_VERTEX_COLORS(x) x
#else
#define HR_IF_VERTEX_COLORS(x)
#endif
#if HR_HAS(SPECULAR)
#define HR_IF_SPECULAR(x) x
#else
#define HR_IF_SPECULAR(x)
#endif
#if HR_HAS(LIGHTS)
#define HR_IF_LIGHTS(x) x
#else
#define HR_IF_LIGHTS(x)
#endif
#if HR_HAS(EMITTERS)
#define HR_IF_EMITTERS(x) x
#else
#define HR_IF_EMITTERS(x)
#endif
#if HR_HAS(SECONDARY)
#define HR_IF_SECONDARY(x) x
#else
#define HR_IF_SECONDARY(x)
#endif
#if HR_HAS(REFLECTION)
#define HR_IF_REFLECTION(x) x
#else
#define HR_IF_REFLECTION(x)
#endif
#if HR_HAS(REFRACTION)
#define HR_IF_REFRACTION(x) x
#else
#define HR_IF_REFRACTION(x)
#endif
#if HR_HAS(BRANCHING)
#define HR_IF_BRANCHING(x) x
#else
#define HR_IF_BRANCHING(x)
#endif
#if HR_HAS(INSTANCES)
#define HR_IF_INSTANCES(x) x
#else
#define HR_IF_INSTANCES(x)
#endif
#if HR_HAS(SHAPES)
#define HR_IF_SHAPES(x) x
#else
#define HR_IF_SHAPES(x)
#endif
#if HR_HAS(IMPLICITS)
#define HR_IF_IMPLICITS(x) x
#else
#define HR_IF_IMPLICITS(x)
#endif
#if HR_HAS(RADIOSITY)
#define HR_IF_RADIOSITY(x) x
#else
#define HR_IF_RADIOSITY(x)
#endif
#if HR_HAS(GATHER)
#define HR_IF_GATHER(x) x
#else
#define HR_IF_GATHER(x)
#endif

#endif

#endif
