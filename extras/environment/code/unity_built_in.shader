// The measured material $NAME for Unity (built-in render pipeline). NOT RUN in Unity: it was written from Unity's documentation, and
// compiled and drawn with functions that stand in for Unity's.
//
// Put this file into a folder below Assets, and create a material of the shader "Measured/$TITLE". The project must use linear
// colours (Player Settings).
Shader "Measured/$TITLE"
{
    Properties
    {
        _Tint ("Tint", Color) = (1, 1, 1, 1)
    }

    CGINCLUDE
    #include "UnityCG.cginc"
    #include "Lighting.cginc"
    #include "AutoLight.cginc"
    #ifndef UNITY_SPECCUBE_LOD_STEPS
    #define UNITY_SPECCUBE_LOD_STEPS 6  // the level of a reflection probe for roughness 1
    #endif

    float4 _Tint;
    static float3x3 to_local;  // its rows are the axes of the surface's frame in world space; the last one is the normal

    float3x3 frame_about(float3 n)
    {
        float3 t = normalize(abs(n.y) < 0.9 ? cross(float3(0, 1, 0), n) : cross(float3(1, 0, 0), n));
        return float3x3(t, cross(n, t), n);
    }

    // The environment, filtered as for GGX of this roughness: the reflection probe, or for roughness 1 the ambient light and light probes,
    // whose values are irradiance / pi.
    float3 probe_radiance(float3 direction, float roughness)
    {
        float3 in_world = mul(direction, to_local);
        if (roughness >= 1.0) return max(ShadeSH9(float4(in_world, 1)), 0.0);
        float level = UNITY_SPECCUBE_LOD_STEPS * roughness * (1.7 - 0.7 * roughness);  // as Unity's own materials look it up
        return DecodeHDR(UNITY_SAMPLE_TEXCUBE_LOD(unity_SpecCube0, in_world, level), unity_SpecCube0_HDR);
    }
    #define $NAME_radiance probe_radiance
$FUNCTIONS

    struct Interpolated
    {
        float4 pos : SV_POSITION;
        float3 position : TEXCOORD0;  // in world space
        float3 normal : TEXCOORD1;
        UNITY_FOG_COORDS(2)
        UNITY_SHADOW_COORDS(3)
    };

    Interpolated vert(appdata_full v)
    {
        Interpolated o;
        UNITY_INITIALIZE_OUTPUT(Interpolated, o);
        o.pos = UnityObjectToClipPos(v.vertex);
        o.position = mul(unity_ObjectToWorld, v.vertex).xyz;
        o.normal = UnityObjectToWorldNormal(v.normal);
        UNITY_TRANSFER_SHADOW(o, v.texcoord1.xy);
        UNITY_TRANSFER_FOG(o, o.pos);
        return o;
    }

    // Sets the frame and returns the direction to the viewer in it. An interpolated normal may face away from the viewer; it is turned back.
    float3 viewer_in_frame(Interpolated i)
    {
        float3 viewer = normalize(UnityWorldSpaceViewDir(i.position)), normal = normalize(i.normal);
        to_local = frame_about(normalize(normal + max(0.01 - dot(normal, viewer), 0.0) * viewer));
        return mul(to_local, viewer);
    }

    // What the light of this pass adds. Unity's own diffuse term lacks 1/pi, therefore the factor pi.
    float3 reflected(Interpolated i, float3 wv)
    {
        UNITY_LIGHT_ATTENUATION(attenuation, i, i.position);
        float3 wl = mul(to_local, normalize(UnityWorldSpaceLightDir(i.position)));
        return UNITY_PI * $NAME_brdf(wl, wv) * max(wl.z, 0.0) * _LightColor0.rgb * attenuation;
    }
    ENDCG

    SubShader
    {
        Tags { "RenderType" = "Opaque" }

        Pass  // the main light, reflection probe, ambient light and light probes
        {
            Tags { "LightMode" = "ForwardBase" }
            CGPROGRAM
            #pragma target 4.5
            #pragma vertex vert
            #pragma fragment frag
            #pragma multi_compile_fwdbase
            #pragma multi_compile_fog
            float4 frag(Interpolated i) : SV_Target
            {
                float3 wv = viewer_in_frame(i);
                float4 colour = float4(_Tint.rgb * (reflected(i, wv) + $NAME_environment(wv)), 1);
                UNITY_APPLY_FOG(i.fogCoord, colour);
                return colour;
            }
            ENDCG
        }

        Pass  // each further light
        {
            Tags { "LightMode" = "ForwardAdd" }
            Blend One One
            ZWrite Off
            CGPROGRAM
            #pragma target 4.5
            #pragma vertex vert
            #pragma fragment frag
            #pragma multi_compile_fwdadd_fullshadows
            #pragma multi_compile_fog
            float4 frag(Interpolated i) : SV_Target
            {
                float4 colour = float4(_Tint.rgb * reflected(i, viewer_in_frame(i)), 1);
                UNITY_APPLY_FOG_COLOR(i.fogCoord, colour, float4(0, 0, 0, 0));
                return colour;
            }
            ENDCG
        }
    }
    FallBack "VertexLit"  // which casts shadows
}
