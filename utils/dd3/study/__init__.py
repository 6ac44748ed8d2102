"""The bending study of docs/reports/bending_study.md."""
