# The rigid-block analyses: one for each load, flow rule and combination of swept values.


rule rigid:
    input:
        settings="rigid/{analysis}/settings.json",
        assemblage=lambda wildcards: f"geometry/{GEOMETRY_OF[wildcards.analysis]}/assemblage.npz",
        contacts=lambda wildcards: f"geometry/{GEOMETRY_OF[wildcards.analysis]}/contacts.npz",
        sources=sources("rigid_blocks", "conic", "stones/joints.py", "config/plan.py", "config/units.py", "io/records.py"),
    output:
        state="rigid/{analysis}/rigid.npz",
        record="rigid/{analysis}/rigid.json",
    shell:
        STAGE + " rigid {wildcards.analysis:q} {input.settings:q} {input.assemblage:q} {input.contacts:q}"
        " {output.state:q} {output.record:q}"
