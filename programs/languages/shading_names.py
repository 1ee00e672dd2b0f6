"""Built-in functions and types of the shading languages, which exported functions cannot be called.

Sources: the GLSL 4.60 and GLSL ES 3.00 specifications, Microsoft's reference of HLSL's intrinsic
functions up to shader model 6.9, Slang's core module, the Metal Shading Language Specification 3.2,
the WGSL specification of 2025, the OSL 1.14 language specification, the CUDA C++ Programming Guide
13.0.
"""

from itertools import product

from programs.languages.spelling import words

# Functions of one or several numbers that most of the languages have
_COMMON = words(
    "abs acos all any asin atan ceil clamp cos cosh cross degrees determinant distance dot exp",
    "exp2 floor fma frexp fwidth ldexp length log log2 max min modf normalize pow radians reflect",
    "refract sign sin sinh smoothstep sqrt step tan tanh transpose trunc",
)


def _shapes(scalars: frozenset[str]) -> frozenset[str]:
    """Return the names of vectors of 1 to 4 numbers, and of matrices up to 4 × 4."""
    sizes = [*"1234", *(f"{rows}x{columns}" for rows, columns in product("1234", "1234"))]
    return frozenset(f"{kind}{size}" for kind, size in product(scalars, sizes))


# GLSL

# Sampler and image types are reserved words: no name of any kind may be one.
GLSL_WORDS = (
    frozenset(
        f"{kind}mat{columns}{rows}"
        for kind, columns, rows in product(
            ("", "d", "f16", "f32", "f64"), "234", ("", "x2", "x3", "x4")
        )
    )
    | frozenset(
        f"{kind}{group}{shape}"
        for kind, group, shape in product(
            ("", "i", "u"),
            ("sampler", "image", "texture"),
            words(
                "1D 2D 3D Cube 2DRect 1DArray 2DArray CubeArray Buffer 2DMS 2DMSArray 1DShadow",
                "2DShadow CubeShadow 2DRectShadow 1DArrayShadow 2DArrayShadow CubeArrayShadow",
            ),
        )
        if not (kind and "Shadow" in shape) and not (group != "sampler" and "Shadow" in shape)
    )
    | frozenset(
        f"{kind}vec{size}"
        for kind, size in product(words("f16 f32 f64 i8 i16 i32 i64 u8 u16 u32 u64"), "234")
    )
    | frozenset(f"{kind}{width}_t" for kind in ("int", "uint") for width in (8, 16, 32, 64))
    | words(
        "atomic_uint demote sampler3DRect subpassInput isubpassInput usubpassInput subpassInputMS",
        "isubpassInputMS usubpassInputMS samplerShadow resource",
    )
)
_GLSL_TEXTURES = {
    f"texture{projected}{how}{offset}"
    for projected, how, offset in product(("", "Proj"), ("", "Lod", "Grad"), ("", "Offset"))
} | {
    f"{kind}{shape}{how}"
    for kind, shape, how in product(
        ("texture", "shadow"), ("1D", "2D", "3D", "Cube"), ("", "Proj", "Lod", "ProjLod", "Bias")
    )
}
# The inputs of Shadertoy are here too, and its main function.
GLSL_LIBRARY = _COMMON | _GLSL_TEXTURES | words(
    "acosh allInvocations allInvocationsEqual anyInvocation asinh atanh atomicAdd atomicAnd",
    "atomicCompSwap atomicCounter atomicCounterAdd atomicCounterAnd atomicCounterCompSwap",
    "atomicCounterDecrement atomicCounterExchange atomicCounterIncrement atomicCounterMax",
    "atomicCounterMin atomicCounterOr atomicCounterSubtract atomicCounterXor atomicExchange",
    "atomicMax atomicMin atomicOr atomicXor barrier bitCount bitfieldExtract bitfieldInsert",
    "bitfieldReverse dFdx dFdxCoarse dFdxFine dFdy dFdyCoarse dFdyFine EmitStreamVertex EmitVertex",
    "EndPrimitive EndStreamPrimitive equal faceforward findLSB findMSB float16BitsToInt16",
    "float16BitsToUint16 floatBitsToInt floatBitsToUint fract ftransform fwidthCoarse fwidthFine",
    "greaterThan greaterThanEqual groupMemoryBarrier imageAtomicAdd imageAtomicAnd",
    "imageAtomicCompSwap imageAtomicExchange imageAtomicMax imageAtomicMin imageAtomicOr",
    "imageAtomicXor imageLoad imageSamples imageSize imageStore imulExtended int16BitsToFloat16",
    "intBitsToFloat interpolateAtCentroid interpolateAtOffset interpolateAtSample inverse",
    "inversesqrt isinf isnan lessThan lessThanEqual matrixCompMult memoryBarrier",
    "memoryBarrierAtomicCounter memoryBarrierBuffer memoryBarrierImage memoryBarrierShared mix mod",
    "noise1 noise2 noise3 noise4 not notEqual outerProduct packDouble2x32 packFloat2x16",
    "packHalf2x16 packInt2x16 packSnorm2x16 packSnorm4x8 packUint2x16 packUnorm2x16 packUnorm4x8",
    "round roundEven subpassLoad texelFetch texelFetchOffset textureGather textureGatherOffset",
    "textureGatherOffsets textureQueryLevels textureQueryLod textureSamples textureSize uaddCarry",
    "uint16BitsToFloat16 uintBitsToFloat umulExtended unpackDouble2x32 unpackFloat2x16",
    "unpackHalf2x16 unpackInt2x16 unpackSnorm2x16 unpackSnorm4x8 unpackUint2x16 unpackUnorm2x16",
    "unpackUnorm4x8 usubBorrow iChannel0 iChannel1 iChannel2 iChannel3 iChannelResolution",
    "iChannelTime iDate iFrame iFrameRate iMouse iResolution iSampleRate iTime iTimeDelta",
    "mainCubemap mainImage mainSound mainVR",
)  # fmt: skip

# HLSL and Slang

HLSL_WORDS = _shapes(
    words(
        "bool int uint dword half float double min16float min10float min16int min12int min16uint",
        "int16_t int32_t int64_t uint16_t uint32_t uint64_t float16_t float32_t float64_t",
    ),
) | words(
    "int16_t int32_t int64_t uint16_t uint32_t uint64_t int8_t4_packed uint8_t4_packed",
    "Texture1DArray Texture2DArray Texture2DMS Texture2DMSArray TextureCubeArray RWTexture1D",
    "RWTexture1DArray RWTexture2D RWTexture2DArray RWTexture3D SamplerComparisonState sampler1D",
    "sampler2D sampler3D samplerCUBE texture1D texture2D texture3D textureCUBE asm asm_fragment",
    "RasterizerOrderedBuffer RasterizerOrderedTexture2D RaytracingAccelerationStructure RayDesc",
    "ConstantBuffer TextureBuffer globallycoherent payload",
)
HLSL_LIBRARY = _COMMON | words(
    "abort AddUint64 AllMemoryBarrier AllMemoryBarrierWithGroupSync and asdouble asfloat asfloat16",
    "asint asint16 asuint asuint16 atan2 Barrier CallShader CheckAccessFullyMapped clip countbits",
    "D3DCOLORtoUBYTE4 ddx ddx_coarse ddx_fine ddy ddy_coarse ddy_fine DeviceMemoryBarrier",
    "DeviceMemoryBarrierWithGroupSync DispatchMesh dot2add dot4add_i8packed dot4add_u8packed dst",
    "errorf EvaluateAttributeAtCentroid EvaluateAttributeAtSample EvaluateAttributeSnapped",
    "f16tof32 f32tof16 faceforward firstbithigh firstbitlow fmod frac GetAttributeAtVertex",
    "GetRenderTargetSampleCount GetRenderTargetSamplePosition GroupMemoryBarrier",
    "GroupMemoryBarrierWithGroupSync InterlockedAdd InterlockedAnd InterlockedCompareExchange",
    "InterlockedCompareStore InterlockedExchange InterlockedMax InterlockedMin InterlockedOr",
    "InterlockedXor IsHelperLane isfinite isinf isnan isnormal lerp lit log10 mad msad4 mul",
    "NonUniformResourceIndex noise or pack_clamp_s8 pack_clamp_u8 pack_s8 pack_u8 printf",
    "Process2DQuadTessFactorsAvg Process2DQuadTessFactorsMax Process2DQuadTessFactorsMin",
    "ProcessIsolineTessFactors ProcessQuadTessFactorsAvg ProcessQuadTessFactorsMax",
    "ProcessQuadTessFactorsMin ProcessTriTessFactorsAvg ProcessTriTessFactorsMax",
    "ProcessTriTessFactorsMin QuadAll QuadAny QuadReadAcrossDiagonal QuadReadAcrossX",
    "QuadReadAcrossY QuadReadLaneAt rcp reversebits ReportHit round rsqrt saturate select",
    "SetMeshOutputCounts sincos tex1D tex1Dbias tex1Dgrad tex1Dlod tex1Dproj tex2D tex2Dbias",
    "tex2Dgrad tex2Dlod tex2Dproj tex3D tex3Dbias tex3Dgrad tex3Dlod tex3Dproj texCUBE texCUBEbias",
    "texCUBEgrad texCUBElod texCUBEproj TraceRay unpack_s8s16 unpack_s8s32 unpack_u8u16",
    "unpack_u8u32 WaveActiveAllEqual WaveActiveAllTrue WaveActiveAnyTrue WaveActiveBallot",
    "WaveActiveBitAnd WaveActiveBitOr WaveActiveBitXor WaveActiveCountBits WaveActiveMax",
    "WaveActiveMin WaveActiveProduct WaveActiveSum WaveGetLaneCount WaveGetLaneIndex",
    "WaveIsFirstLane WaveMatch WaveMultiPrefixBitAnd WaveMultiPrefixBitOr WaveMultiPrefixBitXor",
    "WaveMultiPrefixCountBits WaveMultiPrefixProduct WaveMultiPrefixSum WavePrefixCountBits",
    "WavePrefixProduct WavePrefixSum WaveReadLaneAt WaveReadLaneFirst AcceptHitAndEndSearch",
    "IgnoreHit InstanceID PrimitiveIndex",
)
SLANG_LIBRARY = HLSL_LIBRARY | words(
    "acosh asinh atanh bit_cast bitCast bwd_diff copysign cospi createDynamicObject",
    "detach diffPair DifferentialPair dFdx dFdy exp10 fdim firstbithigh fmax fmax3 fmin fmin3",
    "fract fwd_diff getRealtimeClock getStringHash hypot isDifferentialNull IDifferentiable max3",
    "median3 min3 mix mod nextafter no_diff Optional outerProduct powr rint sinpi sizeof sincospi",
    "spirv_asm static_assert tanpi Tuple makeTuple unused updateDiff",
)

# Metal

METAL_LIBRARY = _COMMON | words(
    "absdiff acosh acospi addsat as_type asinh asinpi atan2 atan2pi atanh atanpi clz copysign",
    "cospi ctz dfdx dfdy discard_fragment distance_squared divide exp10 extract_bits faceforward",
    "fabs fast fdim fmax fmax3 fmedian3 fmin fmin3 fmod fract hadd ilogb insert_bits isfinite",
    "isinf isnan isnormal isordered isunordered length_squared log10 mad24 madhi madsat max3",
    "median3 min3 mix mul24 mulhi nextafter normalize_squared norm popcount powr precise",
    "quad_broadcast quad_shuffle reverse_bits rhadd rint rotate round rsqrt saturate select",
    "signbit simd_all simd_any simd_ballot simd_broadcast simd_max simd_min simd_shuffle simd_sum",
    "simdgroup_barrier sincos sinpi sqrt subsat tanpi threadgroup_barrier pack_float_to_snorm4x8",
    "pack_float_to_unorm4x8 unpack_snorm4x8_to_float unpack_unorm4x8_to_float bool char short int",
    "long uchar ushort uint ulong size_t ptrdiff_t bfloat texture1d texture1d_array",
    "texture2d_array texture2d_ms texture3d texturecube texture_buffer depth2d depthcube",
    "packed_float2 packed_float3 packed_float4 packed_half2 packed_half3 packed_half4 atomic_int",
    "atomic_uint atomic_bool atomic patch_control_point intersector ray intersection_result",
    "command_buffer render_command",
)
METAL_WORDS = frozenset(
    f"{kind}{size}"
    for kind in words("bool char uchar short ushort int uint long ulong half float bfloat")
    for size in "234"
) | frozenset(
    f"{kind}{columns}x{rows}" for kind, columns, rows in product(("half", "float"), "234", "234")
)

# WGSL

_WGSL_TYPES = {f"vec{size}{kind}" for size, kind in product("234", "fhiu")} | {
    f"mat{columns}x{rows}{kind}" for columns, rows, kind in product("234", "234", ("", "f", "h"))
} | {
    f"texture_{shape}"
    for shape in words(
        "1d 2d 2d_array 3d cube cube_array multisampled_2d storage_1d storage_2d storage_2d_array",
        "storage_3d depth_2d depth_2d_array depth_cube depth_cube_array depth_multisampled_2d",
        "external",
    )
}  # fmt: skip
WGSL_LIBRARY = _COMMON | _WGSL_TYPES | words(
    "acosh arrayLength asinh atan2 atanh atomicAdd atomicAnd atomicCompareExchangeWeak",
    "atomicExchange atomicLoad atomicMax atomicMin atomicOr atomicStore atomicSub atomicXor",
    "bitcast countLeadingZeros countOneBits countTrailingZeros dot4I8Packed dot4U8Packed dpdx",
    "dpdxCoarse dpdxFine dpdy dpdyCoarse dpdyFine extractBits faceForward firstLeadingBit",
    "firstTrailingBit fract fwidthCoarse fwidthFine insertBits inverseSqrt isinf isnan mix",
    "pack2x16float pack2x16snorm pack2x16unorm pack4x8snorm pack4x8unorm pack4xI8 pack4xI8Clamp",
    "pack4xU8 pack4xU8Clamp quadBroadcast quadSwapDiagonal quadSwapX quadSwapY quantizeToF16",
    "reverseBits round sampler_comparison saturate select storageBarrier subgroupAdd subgroupAll",
    "subgroupAnd subgroupAny subgroupBallot subgroupBroadcast subgroupBroadcastFirst subgroupElect",
    "subgroupExclusiveAdd subgroupExclusiveMul subgroupInclusiveAdd subgroupInclusiveMul",
    "subgroupMax subgroupMin subgroupMul subgroupOr subgroupShuffle subgroupShuffleDown",
    "subgroupShuffleUp subgroupShuffleXor subgroupXor textureBarrier textureDimensions",
    "textureGather textureGatherCompare textureLoad textureNumLayers textureNumLevels",
    "textureNumSamples textureSample textureSampleBaseClampToEdge textureSampleBias",
    "textureSampleCompare textureSampleCompareLevel textureSampleGrad textureSampleLevel",
    "textureStore unpack2x16float unpack2x16snorm unpack2x16unorm unpack4x8snorm unpack4x8unorm",
    "unpack4xI8 unpack4xU8 workgroupBarrier workgroupUniformLoad bool f16 f32 i32 u32 function",
    "private workgroup uniform storage read read_write",
)  # fmt: skip

# The Open Shading Language: its constants are macros of stdosl.h.

OSL_MACROS = words(
    "M_2PI M_2_PI M_2_SQRTPI M_35PI M_4PI M_E M_LN10 M_LN2 M_LOG10E M_LOG2E M_PI M_PI_2 M_PI_35",
    "M_PI_4 M_SQRT1_2 M_SQRT2 STDOSL_H OSL_VERSION_MAJOR OSL_VERSION_MINOR",
)
OSL_LIBRARY = _COMMON | words(
    "aastep absorption_color adobe_sss anisotropic_vdf area arraycopy arraylength atan2 backfacing",
    "background bitwise blackbody bssrdf bump calculatenormal cbrt cellnoise charpos clearcoat",
    "color concat conductor_bsdf cooktorrance debug deltaE dict_find dict_next dict_value",
    "dielectric dielectric_bsdf diffuse diffuse_ramp displace Dx Dy Dz emission endswith",
    "environment erf erfc error exit expm1 fabs faceforward filterwidth fmod format fprintf",
    "fresnel generalized_schlick generalized_schlick_bsdf getattribute getchar gettextureinfo",
    "getmatrix getmessage hair hash hashnoise holdout hypot inversesqrt isconnected isconstant",
    "isfinite isinf isnan layer linearstep log10 logb luminance matrix medium_vdf microfacet mix",
    "mod noise oren_nayar oren_nayar_diffuse_bsdf pcellnoise phashnoise phong phong_ramp pnoise",
    "point pointcloud_get pointcloud_search pointcloud_write principled_hair principled_volume",
    "printf psnoise raytype reflection refraction regex_match regex_search rotate round select",
    "setmessage sheen sheen_bsdf sincos smooth_linearstep snoise spline splineinverse split",
    "startswith stof stoi strlen strtof strtoi substr subsurface subsurface_bssrdf surfacearea",
    "texture texture3d trace transform transformc transformu translucent translucent_bsdf",
    "transmission_color transparent transparent_bsdf uniform_edf ashikhmin_shirley",
    "ashikhmin_velvet volume_henyey_greenstein volume_absorption ward warning wavelength_color",
    "toon diffuse_toon glossy_toon westin_backscatter westin_sheen bsdf_reflection",
    "henyey_greenstein ambient_occlusion main",
)

# CUDA: what its mathematical library adds to that of C

_CUDA_MATH = words(
    "cospi cyl_bessel_i0 cyl_bessel_i1 erfcinv erfcx erfinv exp10 fdivide max min norm norm3d",
    "norm4d normcdf normcdfinv rcbrt rhypot rnorm rnorm3d rnorm4d rsqrt sincos sincospi sinpi",
)
CUDA_WORDS = frozenset(
    f"{kind}{size}"
    for kind in words("char uchar short ushort int uint long ulong longlong ulonglong float double")
    for size in "1234"
)
CUDA_LIBRARY = (
    frozenset(name + end for name, end in product(_CUDA_MATH, ("", "f")))
    | frozenset(f"make_{each}" for each in CUDA_WORDS)
    | words(
        "atomicAdd atomicAnd atomicCAS atomicDec atomicExch atomicInc atomicMax atomicMin atomicOr",
        "atomicSub atomicXor clock clock64 llmax llmin ullmax ullmin umax umin half2 mulhi mul24",
        "saturate surf1Dread surf2Dread tex1D tex1Dfetch tex2D tex2DLod tex3D texCubemap texture",
        "cudaError cudaFree cudaMalloc cudaMemcpy cudaStream_t",
    )
)
