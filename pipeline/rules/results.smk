# What people and programs read.


rule compare:
    input:
        plan="plan.json",
        sizes=expand("geometry/{geometry}/{part}.npz", geometry=GEOMETRIES, part=["assemblage", "contacts"]),
        analyses=expand("rigid/{analysis}/rigid.json", analysis=ANALYSES),
        sources=sources("compare.py", "io/tables.py"),
    output:
        summary="summary.json",
        table="table.csv",
    shell:
        STAGE + " compare all {input.plan:q} {output.summary:q} {output.table:q}"


for number, geometry in enumerate(GEOMETRIES):

    rule:
        name:
            f"report_{number}" if number else "report"
        input:
            plan="plan.json",
            case="as-run.toml",
            summary="summary.json",
            assemblage=f"geometry/{geometry}/assemblage.npz",
            contacts=f"geometry/{geometry}/contacts.npz",
            states=[f"rigid/{analysis}/rigid.npz" for analysis, place in ANALYSES.items() if place == geometry],
            sources=sources("report", "io/vtu.py"),
        output:
            html=report_of(geometry),
            mechanisms=[f"rigid/{analysis}/mechanism.vtu" for analysis, place in ANALYSES.items() if place == geometry],
        shell:
            STAGE + " report {output.html:q} {input.plan:q} {input.summary:q} {input.assemblage:q} {input.contacts:q} {output.html:q}"
