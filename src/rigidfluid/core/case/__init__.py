"""A scene becomes a model: its tables read together, the parts that they name found, its formulas made functions."""
